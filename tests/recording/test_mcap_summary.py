"""What the end of an MCAP file says, and that no wrong word of it is believed."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from mcap.writer import Writer
from recordings import SECOND, START, piston_recording

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter
from eha_core.recording.mcap_summary import is_finished, mcap_extent, mcap_metadata, summary_of

FOOTER = 8 + 8 + 4
"""Bytes of a footer: where the summary starts, where its offsets start, its checksum. Then comes the magic's 8."""


def changed(path: Path, place: int, content: bytes) -> Path:
    """The file with some bytes of its end changed, counted from the end."""
    data = bytearray(path.read_bytes())
    data[len(data) - place : len(data) - place + len(content)] = content
    path.write_bytes(data)
    return path


def start_of_summary(path: Path) -> int:
    (start,) = struct.unpack_from("<Q", path.read_bytes(), path.stat().st_size - 8 - FOOTER)
    return int(start)


def test_a_finished_file_tells_its_span_and_its_metadata(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, {"moving_mass": 9.0}) as writer:
        for k in (2, 5, 9):
            writer.write_fields("/gain", "std_msgs/msg/Float64", {"data": 1.0}, START + k * SECOND)
    assert is_finished(path)
    assert mcap_extent(path) == (START + 2 * SECOND, START + 9 * SECOND)
    ((_, stored),) = mcap_metadata(path).items()
    assert float(stored["moving_mass"]) == 9.0


@pytest.mark.parametrize("lost", [1, 8, 9, 28, 37, 200])
def test_a_file_whose_end_is_missing_tells_nothing(tmp_path: Path, lost: int) -> None:
    path = piston_recording(tmp_path / "run.mcap")
    path.write_bytes(path.read_bytes()[:-lost])
    assert not is_finished(path)
    assert mcap_extent(path) is None and mcap_metadata(path) == {}


def test_a_summary_with_a_wrong_byte_is_not_believed_and_one_without_a_checksum_is(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap")
    sound = path.read_bytes()
    start = start_of_summary(path)
    for place in (start + 40, len(sound) - 8 - FOOTER + 8):  # in the summary, and in the footer's other number
        data = bytearray(sound)
        data[place] ^= 1
        path.write_bytes(data)
        assert not is_finished(path)
    path.write_bytes(sound)
    assert is_finished(path)
    assert not is_finished(changed(path, 8 + 4, b"\1\2\3\4"))
    assert is_finished(changed(path, 8 + 4, bytes(4)))


@pytest.mark.parametrize("where", [0, -1, 1, 10**6, 2**63])
def test_a_summary_that_starts_elsewhere_is_none(tmp_path: Path, where: int) -> None:
    """At zero, where a file has none; at the file's end and beyond; with no checksum that could tell."""
    path = piston_recording(tmp_path / "run.mcap", count=3)
    start = path.stat().st_size if where == -1 else where
    changed(changed(path, 8 + 4, bytes(4)), 8 + FOOTER, struct.pack("<Q", start))
    assert not is_finished(path)
    assert mcap_extent(path) is None


def test_a_file_without_messages_has_no_span(tmp_path: Path) -> None:
    path = tmp_path / "none.mcap"
    with RecordingWriter(path, {"moving_mass": 9.0}):
        pass
    assert is_finished(path) and mcap_extent(path) is None
    assert len(mcap_metadata(path)) == 1


def test_metadata_of_one_name_are_put_together(tmp_path: Path) -> None:
    path = tmp_path / "others.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for name, data in (("rig", {"a": "1", "b": "2"}), ("other", {"a": "3"}), ("rig", {"b": "4"})):
            writer.add_metadata(name, data)
        writer.finish()
    assert mcap_metadata(path) == {"rig": {"a": "1", "b": "4"}, "other": {"a": "3"}}


def test_what_is_no_mcap_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "text.mcap"
    for content, message in ((b"", "the file is empty; record again"), (b"hello, text", "not an MCAP file")):
        path.write_bytes(content)
        for read in (mcap_extent, mcap_metadata):
            with pytest.raises(RecordingError, match=message):
                read(path)
    with pytest.raises(RecordingError, match=r"none.mcap: cannot be read \(No such file"):
        mcap_extent(tmp_path / "none.mcap")


def test_a_summary_is_read_wherever_the_file_stands(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap")
    with path.open("rb") as file:
        file.seek(100)
        summary = summary_of(file, path.stat().st_size)
    assert summary and summary.statistics and summary.statistics.message_count == 400
    assert len(summary.channels) == 4
