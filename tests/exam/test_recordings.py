"""The exam's recordings as files: the library that is examined reads what its own writer would have written."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from eha_core.recording import RecordingWriter
from eha_core.recording import read_recording as read_by_the_library
from eha_exam.drawing import draw_case
from eha_exam.errors import ExamError
from eha_exam.files import write_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.recordings import PRESSURE, START, TOPICS, Arrays, read_recording, write_recording


@pytest.fixture(scope="module")
def arrays() -> tuple[dict[str, float], Arrays]:
    """A short recording with jitter and gaps, and its nominal parameters."""
    case = replace(draw_case("single", 0, 3), duration=4.0, rate=500.0, jitter=2e-4, dropout=0.05)
    return dict(case.nominal), measure(case, simulate_case(case))


@pytest.fixture(scope="module")
def path(arrays: tuple[dict[str, float], Arrays], tmp_path_factory: pytest.TempPathFactory) -> Path:
    written = tmp_path_factory.mktemp("recordings") / "folder" / "recording.mcap"
    write_recording(written, arrays[1], arrays[0])
    return written


def test_the_library_reads_it_back_to_the_last_bit(path: Path, arrays: tuple[dict[str, float], Arrays]) -> None:
    nominal, made = arrays
    recording = read_by_the_library(path)
    assert dict(recording.parameters) == nominal
    assert set(recording.channels) == set(made) and not recording.damaged
    first = min(round(time[0] * 1e9) for time, _ in made.values())
    atmosphere = nominal["atmospheric_pressure"]
    for name, (time, values) in made.items():
        channel = recording.channels[name]
        np.testing.assert_array_equal(channel.time, (np.round(time * 1e9).astype(np.int64) - first) / 1e9)
        absolute = values + atmosphere - atmosphere if name.startswith("pressure") else values
        np.testing.assert_array_equal(channel.values, absolute)


def test_the_exam_s_own_reader_agrees_with_the_library_s(path: Path) -> None:
    own, library = read_recording(path), read_by_the_library(path)
    assert own.parameters == dict(library.parameters)
    assert list(own.channels) == [name for name in TOPICS if name in library.channels]
    for name, (time, values) in own.channels.items():
        np.testing.assert_array_equal(time, library.channels[name].time)
        np.testing.assert_array_equal(values, library.channels[name].values)


def contents(path: Path) -> tuple[object, ...]:
    """Everything that a file holds but how it is packed."""
    with path.open("rb") as stream:
        reader = make_reader(stream)
        records = [(record.name, record.metadata) for record in reader.iter_metadata()]
        profile = reader.get_header().profile
        messages = [
            (schema.name, schema.encoding, schema.data, channel.topic, channel.message_encoding, channel.metadata,
             message.log_time, message.publish_time, message.data)
            for schema, channel, message in reader.iter_messages()
        ]  # fmt: skip
    return profile, records, messages


def test_its_messages_are_those_of_the_library_s_own_writer(
    path: Path, arrays: tuple[dict[str, float], Arrays], tmp_path: Path
) -> None:
    nominal, made = arrays
    rows = []
    for name, (time, values) in made.items():
        topic, kind = TOPICS[name]
        stamps = (START + np.round(time * 1e9).astype(np.int64)).tolist()
        for stamp, value in zip(stamps, values.tolist(), strict=True):
            header = {"header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}}}
            fields = {"data": value}
            if name == "position":
                fields = {"name": ["piston"], "position": [value], **header}
            elif kind == PRESSURE:
                fields = {"fluid_pressure": value + nominal["atmospheric_pressure"], **header}
            rows.append((stamp, topic, kind, fields))
    other = tmp_path / "library.mcap"
    with RecordingWriter(other, parameters=nominal, flush_period=60.0) as writer:
        for stamp, topic, kind, fields in sorted(rows, key=lambda row: row[0]):
            writer.write_fields(topic, kind, fields, stamp)
    assert contents(path) == contents(other)


def test_a_topic_is_found_under_a_namespace_and_without_parameters() -> None:
    shipped = Path(__file__).parents[2] / "bags" / "rig_valve_deadband.mcap"
    own, library = read_recording(shipped), read_by_the_library(shipped)
    assert own.parameters == {}
    for name in TOPICS:
        np.testing.assert_array_equal(own.channels[name][1], library.channels[name].values)


def test_what_cannot_be_written_or_read_is_said_in_one_line(
    path: Path, arrays: tuple[dict[str, float], Arrays], tmp_path: Path
) -> None:
    with pytest.raises(ExamError, match="cannot be written"):
        write_recording(path, arrays[1], arrays[0])
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(path.read_bytes()[:5000])
    for unusable in (tmp_path / "none.mcap", torn):
        with pytest.raises(ExamError, match="cannot be read"):
            read_recording(unusable)
    case = replace(draw_case("null", 0, 3), channels=())
    write_case(case, {}, tmp_path / "empty.mcap")
    with pytest.raises(ExamError, match="has none of the topics voltage_command, joint_states"):
        read_recording(tmp_path / "empty.mcap")
