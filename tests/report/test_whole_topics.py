"""Whole topics written at once: what any reader finds is what a message written after another leaves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter
from eha_core.recording.message_rows import encode_rows
from eha_core.report.whole_topics import CHUNK, Topic, write_topics

FLOAT, PRESSURE = "std_msgs/msg/Float64", "sensor_msgs/msg/FluidPressure"
PARAMETERS = {"moving_mass": 9.0}


def topics() -> list[Topic]:
    """Two that interleave, one that begins later, one without a message; more than a chunk takes."""
    fast, slow, late = np.arange(0, 20_000) * 500, np.arange(0, 8_000) * 1250, 4_000_000 + np.arange(0, 300) * 1000
    numbers = np.random.default_rng(3)
    pressure = encode_rows(PRESSURE, {"fluid_pressure": numbers.standard_normal(len(fast))}, fast)
    return [
        Topic("/measured/chamber_a/pressure", PRESSURE, fast, pressure),
        Topic("/measured/voltage_command", FLOAT, slow, encode_rows(FLOAT, {"data": numbers.random(len(slow))})),
        Topic("/residual/position", FLOAT, late, encode_rows(FLOAT, {"data": numbers.random(len(late))})),
        Topic("/residual/force", FLOAT, np.empty(0, np.int64), []),
    ]


def messages(path: Path, reader) -> list[tuple]:
    """Everything that a reader which checks the sums finds, ordered by stamp and topic."""
    with path.open("rb") as stream:
        found = [
            (message.log_time, channel.topic, message.publish_time, message.data, schema.name, schema.data, channel)
            for schema, channel, message in reader(stream, validate_crcs=True).iter_messages()
        ]
    return sorted((*one[:6], one[6].message_encoding, sorted(one[6].metadata.items())) for one in found)


@pytest.fixture
def both(tmp_path: Path) -> tuple[Path, Path]:
    """The same messages at once, and one after another."""
    at_once, one_by_one = tmp_path / "at_once.mcap", tmp_path / "one_by_one.mcap"
    several = topics()
    assert write_topics(at_once, several, PARAMETERS) == sum(len(topic.data) for topic in several)
    with RecordingWriter(one_by_one, PARAMETERS) as writer:
        for topic in several:
            for stamp, data in zip(topic.stamps.tolist(), topic.data, strict=True):
                writer.write(topic.name, topic.type_name, data, stamp)
    return at_once, one_by_one


@pytest.mark.parametrize("reader", [make_reader, NonSeekingReader])
def test_every_reader_finds_what_messages_written_one_by_one_leave(both: tuple[Path, Path], reader) -> None:
    at_once, one_by_one = both
    assert messages(at_once, reader) == messages(one_by_one, reader)


def test_the_messages_stand_in_the_order_of_their_stamps_and_the_summary_counts_them(both: tuple[Path, Path]) -> None:
    with both[0].open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        metadata = [(record.name, record.metadata) for record in reader.iter_metadata()]
    with both[0].open("rb") as stream:
        stamps = [message.log_time for _, _, message in NonSeekingReader(stream).iter_messages(log_time_order=False)]
    assert stamps == sorted(stamps)
    assert metadata == [("eha_parameters", {"moving_mass": "9.0"})]
    counts = {summary.channels[number].topic: count
              for number, count in summary.statistics.channel_message_counts.items()}  # fmt: skip
    assert counts == {topic.name: len(topic.data) for topic in topics() if topic.data}
    assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (0, 9_999_500)
    assert len(summary.chunk_indexes) > 1
    longest = max(index.uncompressed_size for index in summary.chunk_indexes)
    assert longest < 1.1 * CHUNK


def test_part_of_the_time_is_found_by_the_index(both: tuple[Path, Path]) -> None:
    with both[0].open("rb") as stream:
        some = make_reader(stream).iter_messages(["/measured/voltage_command"], starting_at=1250, ending_before=5000)
        assert [message.log_time for _, _, message in some] == [1250, 2500, 3750]


def test_nothing_to_write_is_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "empty.mcap"
    assert write_topics(path, [], {}) == 0
    assert messages(path, make_reader) == []


def test_a_file_that_is_there_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "there.mcap"
    path.write_text("mine")
    with pytest.raises(RecordingError, match=r"there\.mcap: exists already"):
        write_topics(path, topics(), PARAMETERS)
    assert path.read_text() == "mine"
    with pytest.raises(RecordingError, match="cannot be written"):
        write_topics(path / "below", topics(), PARAMETERS)
