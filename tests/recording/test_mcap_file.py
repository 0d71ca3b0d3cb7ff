"""MCAP files built record by record: which are taken, which left out, and that what is missing is counted."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import pytest
from mcap.data_stream import RecordBuilder
from mcap.records import Channel, Chunk, DataEnd, Footer, Header, McapRecord, Message, Metadata, Schema
from recordings import SECOND, START

from eha_core.errors import RecordingError
from eha_core.recording import encode, read_recording
from eha_core.recording.mcap_file import mcap_topics

FLOAT, MAGIC = "std_msgs/msg/Float64", b"\x89MCAP0\r\n"
SCHEMA = Schema(id=1, name=FLOAT, encoding="ros2msg", data=b"float64 data")


def channel(number: int = 1, topic: str = "/voltage_command", encoding: str = "cdr", schema: int = 1) -> Channel:
    return Channel(id=number, topic=topic, message_encoding=encoding, metadata={}, schema_id=schema)


def message(second: int, number: int = 1) -> Message:
    stamp = START + second * SECOND
    data = encode(FLOAT, {"data": float(second)})
    return Message(channel_id=number, sequence=0, log_time=stamp, publish_time=stamp, data=data)


def built(*records: McapRecord) -> bytes:
    builder: Any = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())


def a_chunk(content: bytes, checksum: int = 0, size: int | None = None) -> Chunk:
    size = len(content) if size is None else size
    return Chunk(
        compression="", data=content, message_start_time=0, message_end_time=0, uncompressed_crc=checksum,
        uncompressed_size=size,
    )  # fmt: skip


def a_file(folder: Path, *records: McapRecord, end: bytes = b"") -> Path:
    path = folder / "run.mcap"
    closing = built(DataEnd(data_section_crc=0), Footer(summary_start=0, summary_offset_start=0, summary_crc=0)) + MAGIC
    path.write_bytes(MAGIC + built(Header(profile="ros2", library=""), *records) + (end or closing))
    return path


def values(path: Path) -> list[float]:
    return read_recording(path).channels["voltage_command"].values.tolist()


WHOLE = built(SCHEMA, channel(), message(0), message(1))


@pytest.mark.parametrize("checksum", [0, zlib.crc32(WHOLE)])
def test_messages_in_chunks_and_beside_them_are_read(tmp_path: Path, checksum: int) -> None:
    path = a_file(tmp_path, a_chunk(WHOLE, checksum), message(2), a_chunk(built(message(3), message(4))))
    assert values(path) == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert read_recording(path).damaged == (
        "it was not finished: what its recorder had not put on disk yet is missing; what was read covers 4 s"
    )
    assert set(mcap_topics(path)) == {"/voltage_command"}


@pytest.mark.parametrize(
    "content",
    [
        WHOLE[:-1],  # a message ends beyond the chunk
        WHOLE[:-30],
        WHOLE + b"\x05\x01\x02",  # something follows that is no record
        WHOLE + b"\x80" + (1).to_bytes(8, "little"),  # a record of a private kind that has no content
        WHOLE + b"\x05" + (2**64 - 40).to_bytes(8, "little") + bytes(30),  # a length that leads back
        WHOLE + b"\x05" + (3).to_bytes(8, "little") + bytes(30),  # one that ends within its own head
        WHOLE + b"\x05" + (3).to_bytes(8, "little") + b"\1\0\0\x80" + (10).to_bytes(8, "little") + bytes(10),
    ],
)
def test_a_chunk_whose_records_do_not_fill_it_is_left_out_whole(tmp_path: Path, content: bytes) -> None:
    path = a_file(tmp_path, SCHEMA, channel(), message(7), a_chunk(content), message(9))
    assert values(path) == [7.0, 9.0]
    assert str(read_recording(path).damaged).startswith("damaged chunks left out: 1; what was read")


def test_a_chunk_of_another_checksum_or_size_is_left_out(tmp_path: Path) -> None:
    wrong = (a_chunk(WHOLE, zlib.crc32(WHOLE) ^ 1), a_chunk(WHOLE, 0, len(WHOLE) - 1), a_chunk(WHOLE, 0, 2**27))
    path = a_file(tmp_path, SCHEMA, channel(), message(7), *wrong, message(9))
    assert values(path) == [7.0, 9.0]
    assert str(read_recording(path).damaged).startswith("damaged chunks left out: 3; what was read")


def test_a_message_of_no_bytes_is_one_and_costs_no_other(tmp_path: Path) -> None:
    empty = Message(channel_id=1, sequence=0, log_time=START, publish_time=START, data=b"")
    path = a_file(tmp_path, a_chunk(WHOLE + built(empty, message(2), empty)))
    assert values(path) == [0.0, 1.0, 2.0]
    assert read_recording(path).remarks == ("/voltage_command: 2 messages that do not decode were left out",)


def test_a_private_record_and_an_empty_chunk_are_passed_over(tmp_path: Path) -> None:
    private = b"\x80" + (5).to_bytes(8, "little") + b"hello"
    path = a_file(tmp_path, a_chunk(b""), a_chunk(WHOLE[:0] + private + WHOLE + private))
    assert values(path) == [0.0, 1.0]


def test_messages_of_a_topic_that_nothing_describes_are_counted(tmp_path: Path) -> None:
    path = a_file(tmp_path, a_chunk(WHOLE + built(message(2, 9), message(3, 9))), message(4, 8))
    assert values(path) == [0.0, 1.0]
    want = "messages left out for want of their topic's description: 3; what was read covers 1 s"
    assert read_recording(path).damaged == want


def test_messages_of_another_encoding_are_not_read(tmp_path: Path) -> None:
    path = a_file(tmp_path, SCHEMA, channel(1, "/voltage_command", "json"), message(0), message(1))
    with pytest.raises(RecordingError, match="no usable channel"):
        read_recording(path)
    assert mcap_topics(path)["/voltage_command"].type_name == FLOAT


def test_a_topic_without_a_schema_is_listed_without_a_type(tmp_path: Path) -> None:
    topics = mcap_topics(a_file(tmp_path, SCHEMA, channel(), channel(2, "/other", schema=0), message(0)))
    assert {name: (one.type_name, one.encoding, one.definition) for name, one in topics.items()} == {
        "/voltage_command": (FLOAT, "ros2msg", "float64 data"),
        "/other": ("", "", ""),
    }


def test_two_channels_of_one_topic_are_one(tmp_path: Path) -> None:
    path = a_file(tmp_path, SCHEMA, channel(), channel(2), message(0), message(1, 2), message(2))
    assert values(path) == [0.0, 1.0, 2.0]


def test_metadata_of_an_unfinished_file_are_read_and_later_ones_count(tmp_path: Path) -> None:
    first, later = ({"moving_mass": "9", "piston_area": "1e-3"}, {"moving_mass": "8"})
    metadata = [Metadata(name="eha_parameters", metadata=one) for one in (first, later)]
    path = a_file(tmp_path, metadata[0], a_chunk(WHOLE), metadata[1])
    assert read_recording(path).parameters == {"moving_mass": 8.0, "piston_area": 1e-3}


@pytest.mark.parametrize("lost", [1, 30, 45])
def test_of_a_last_chunk_that_is_cut_the_whole_messages_are_kept(tmp_path: Path, lost: int) -> None:
    content = built(*(message(k) for k in range(2, 6)))
    whole = built(a_chunk(content))
    path = a_file(tmp_path, a_chunk(WHOLE), end=whole[:-lost])
    size, place = path.stat().st_size, path.stat().st_size - len(whole) + lost
    each = len(content) // 4
    kept = [0.0, 1.0, *(2.0 + k for k in range((len(content) - lost) // each))]
    assert values(path) == kept
    assert str(read_recording(path).damaged).startswith(
        f"its end is missing, from within the chunk at byte {place} of {size} on; what was read covers"
    )


def test_an_end_that_holds_nothing_is_missing_or_unreadable(tmp_path: Path) -> None:
    path = a_file(tmp_path, a_chunk(WHOLE), end=b"\x03")
    size = path.stat().st_size
    assert str(read_recording(path).damaged).startswith(f"1 bytes from byte {size - 1} of {size} could not be read; ")
    path = a_file(tmp_path, a_chunk(WHOLE), message(2))
    path.write_bytes(path.read_bytes()[: -8 - 29 - 13])
    assert str(read_recording(path).damaged).startswith("its end is missing; what was read covers 2 s")
    path = a_file(tmp_path, a_chunk(WHOLE), end=bytes(40))
    size = path.stat().st_size
    assert str(read_recording(path).damaged).startswith(f"40 bytes from byte {size - 40} of {size} could not be read; ")
