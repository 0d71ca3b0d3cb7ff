"""Damaged files: cut at any byte, with bytes turned over anywhere; the rest is saved or one line says why not."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import lz4.frame
import numpy as np
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.records import Chunk, DataEnd, Footer, Header
from mcap.writer import Writer as McapWriter
from recordings import SECOND, START, write_piston
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import Recording, RecordingWriter, encode, read_recording


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A recording of 40 chunks of 20 samples, 8 s in all."""
    path = tmp_path_factory.mktemp("sound") / "run.mcap"
    with RecordingWriter(path, flush_period=1e9) as writer:
        for part in range(40):
            write_piston(writer, count=20, start=START + part * SECOND // 5)
            writer.flush()
    return path.read_bytes()


def read_bytes(folder: Path, content: bytes) -> Recording | None:
    """The recording saved from `content`; None where it was refused, which must take one line."""
    path = folder / "damaged.mcap"
    path.write_bytes(content)
    try:
        return read_recording(path)
    except RecordingError as error:
        assert "\n" not in str(error)
        return None


def test_a_cut_at_any_byte_leaves_what_came_before(tmp_path: Path, sound: bytes) -> None:
    generator = np.random.default_rng(1)
    cuts = [0, 1, 7, 8, 9, *sorted(generator.integers(10, len(sound), 80)), len(sound) - 8, len(sound) - 1]
    lengths = []
    for cut in cuts:
        recording = read_bytes(tmp_path, sound[:cut])
        if recording is None:
            assert not lengths, f"cut at {cut}: refused although a shorter part could be read"
            continue
        assert (
            recording.damaged is not None
            and "could not be read" in recording.damaged
            or "missing" in str(recording.damaged)
        )
        lengths.append(len(recording.channels["position"].time))
        share = cut / len(sound)
        assert lengths[-1] >= 800 * share - 30, f"cut at {cut}: only {lengths[-1]} samples saved"
    assert lengths == sorted(lengths)
    assert lengths[-1] == 800


@pytest.mark.parametrize("others", [False, True])
def test_a_cut_inside_the_only_chunk_leaves_its_beginning(tmp_path: Path, others: bool) -> None:
    path = tmp_path / "run" / "run.mcap"
    if others:
        store = get_typestore(Stores.ROS2_JAZZY)
        with Writer(path.parent, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection("/voltage_command", "std_msgs/msg/Float64", typestore=store)
            for k in range(20_000):
                writer.write(connection, START + k, encode("std_msgs/msg/Float64", {"data": k * 1e-3}))
    else:
        with RecordingWriter(path, flush_period=1e9) as mine:
            write_piston(mine, count=20_000, topics=("voltage_command",))
    content = path.read_bytes()
    recording = read_bytes(tmp_path, content[: len(content) // 4])
    assert recording is not None and recording.damaged is not None
    values = recording.channels["voltage_command"].values
    assert 2000 < len(values) < 19_000
    assert recording.damaged.startswith("its end is missing, from within the chunk at byte ")
    np.testing.assert_allclose(values, np.arange(len(values)) * 1e-3)
    assert not recording.remarks


def test_bytes_turned_over_anywhere_cost_at_most_their_chunk(tmp_path: Path, sound: bytes) -> None:
    generator = np.random.default_rng(2)
    for position in generator.integers(8, len(sound), 100):
        content = bytearray(sound)
        content[position] ^= 1 << int(generator.integers(8))
        recording = read_bytes(tmp_path, bytes(content))
        assert recording is not None, f"byte {position}: refused"
        samples = len(recording.channels["position"].time)
        assert samples in (780, 800), f"byte {position}: {samples} samples"
        assert samples == 800 or recording.damaged is not None
        assert np.all(np.diff(recording.channels["position"].time) > 0)


def test_a_hole_in_the_middle_is_jumped_over(tmp_path: Path, sound: bytes) -> None:
    content = bytearray(sound)
    first, last = len(sound) // 3, len(sound) // 3 + 5000
    content[first:last] = bytes(last - first)
    recording = read_bytes(tmp_path, bytes(content))
    assert recording is not None and recording.damaged is not None
    assert f"of {len(sound)} could not be read" in recording.damaged
    assert recording.duration > 7.9
    assert 500 < len(recording.channels["position"].time) < 800


def zeroed(content: bytes, first: int, last: int) -> bytes:
    return content[:first] + bytes(last - first) + content[last:]


def test_what_the_summary_promises_and_is_not_there_is_counted(tmp_path: Path, sound: bytes) -> None:
    """A chunk overwritten by another leaves a sound structure; only the summary's count tells of it."""
    with (tmp_path / "sound.mcap").open("wb") as file:
        file.write(sound)
    with (tmp_path / "sound.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    first = summary.chunk_indexes[5]
    empty = bytes([0x80]) + (first.chunk_length - 9).to_bytes(8, "little")  # a record of a private kind, to be skipped
    content = bytearray(sound)
    content[first.chunk_start_offset : first.chunk_start_offset + 9] = empty
    recording = read_bytes(tmp_path, bytes(content))
    assert recording is not None and recording.damaged is not None
    assert "80 of 3200 messages are missing" in recording.damaged


def test_a_zeroed_end_of_an_unfinished_file_is_told(tmp_path: Path) -> None:
    """A disk that lost power leaves zeros where the last flush went."""
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, flush_period=1e9)
    for part in range(4):
        write_piston(writer, count=20, start=START + part * SECOND)
        writer.flush()
    writer.abandon()
    content = path.read_bytes()
    recording = read_bytes(tmp_path, zeroed(content, len(content) - 600, len(content)))
    assert recording is not None and recording.damaged is not None
    assert f"of {len(content)} could not be read" in recording.damaged


def chunk_of(path: Path, content: bytes, size: int, compression: str = "zstd") -> Path:
    """An MCAP whose one chunk claims to unpack to `size` bytes."""
    builder: Any = RecordBuilder()
    Header(profile="ros2", library="").write(builder)
    Chunk(compression, content, 0, 0, 0, size).write(builder)
    DataEnd(0).write(builder)
    Footer(0, 0, 0).write(builder)
    path.write_bytes(b"\x89MCAP0\r\n" + builder.end() + b"\x89MCAP0\r\n")
    return path


@pytest.mark.parametrize("pack", ["zstd", "lz4"])
def test_a_small_file_cannot_take_the_memory(tmp_path: Path, pack: str) -> None:
    size = 2**26
    zeros = bytes(size)
    content = zstandard.compress(zeros) if pack == "zstd" else lz4.frame.compress(zeros)
    path = chunk_of(tmp_path / "bomb.mcap", content, size, pack)
    tracemalloc.start()
    with pytest.raises(RecordingError, match="unpacks to more than"):
        read_recording(path)
    assert tracemalloc.get_traced_memory()[1] < 8e6
    tracemalloc.stop()


@pytest.mark.parametrize("pack", ["zstd", "lz4"])
def test_a_chunk_that_hides_its_size_is_left_out(tmp_path: Path, pack: str) -> None:
    zeros = bytes(2**27)
    content = zstandard.compress(zeros) if pack == "zstd" else lz4.frame.compress(zeros)
    del zeros
    path = chunk_of(tmp_path / "bomb.mcap", content, 1000, pack)
    with pytest.raises(RecordingError, match="damaged chunks left out: 1"):
        read_recording(path)


def test_random_bytes_after_the_magic_are_refused(tmp_path: Path) -> None:
    generator = np.random.default_rng(3)
    for _ in range(50):
        assert read_bytes(tmp_path, b"\x89MCAP0\r\n" + generator.bytes(400)) is None


def test_a_message_that_does_not_decode_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        write_piston(writer, count=3, topics=("voltage_command",))
        writer.write("/voltage_command", "std_msgs/msg/Float64", b"\0\1\0\0\0\0", START + SECOND)
    recording = read_recording(path)
    assert len(recording.channels["voltage_command"].time) == 3
    assert recording.remarks == ("/voltage_command: 1 messages that do not decode were left out",)


@pytest.mark.parametrize("definition", [b"float65 data", b"std_msgs/Absent data", b"\xff\xfe", b"float64 data ["])
def test_a_damaged_definition_gives_way_to_the_installed_one(tmp_path: Path, definition: bytes) -> None:
    path = tmp_path / "run.mcap"
    writer: Any = McapWriter(str(path))
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", definition)
    channel = writer.register_channel("/voltage_command", "cdr", schema)
    writer.add_message(channel, START, encode("std_msgs/msg/Float64", {"data": 0.5}), START)
    writer.finish()
    assert read_recording(path).channels["voltage_command"].values.tolist() == [0.5]


@pytest.mark.parametrize("numbers", [(5,), (5, 9, 20)])
def test_damaged_chunks_are_counted_with_their_messages(tmp_path: Path, sound: bytes, numbers: tuple[int, ...]) -> None:
    (tmp_path / "sound.mcap").write_bytes(sound)
    with (tmp_path / "sound.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    content = bytearray(sound)
    for number in numbers:
        index = sorted(summary.chunk_indexes, key=lambda one: one.chunk_start_offset)[number]
        content[index.chunk_start_offset + index.chunk_length - 20] ^= 1
    recording = read_bytes(tmp_path, bytes(content))
    assert recording is not None and recording.damaged is not None
    remarks = recording.damaged.split("; ")
    assert remarks[0] == f"damaged chunks left out: {len(numbers)}"
    assert remarks[1] == f"{80 * len(numbers)} of 3200 messages are missing"
    assert len(recording.channels["position"].time) == 800 - 20 * len(numbers)
