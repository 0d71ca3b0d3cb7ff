"""A record in blocks: the same samples as read at once, however it is read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recordings import START, header

from eha_core.errors import RecordingError
from eha_core.recording import Recording, RecordingWriter, blocks, read_recording
from eha_core.recording.blocks import Block, Blocks, BlocksInMemory, BlocksOfFile
from eha_core.recording.cutting import cut_out, leakage_within
from eha_core.recording.message_types import encode

FLOAT, JOINTS, PRESSURE = "std_msgs/msg/Float64", "sensor_msgs/msg/JointState", "sensor_msgs/msg/FluidPressure"
RATE, SECONDS = 50, 23.0


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rig whose command changes every 7 s and is sent only then, and whose leakage is turned at 12 s."""
    file = tmp_path_factory.mktemp("blocks") / "run.mcap"
    with RecordingWriter(file, {"moving_mass": 9.5, "atmospheric_pressure": 1e5}) as writer:
        for row in range(int(SECONDS * RATE) + 1):
            if row % RATE == 0:
                writer.flush()
            stamp = START + row * 1_000_000_000 // RATE
            time = row / RATE
            if row % (7 * RATE) == 0:
                writer.write("/voltage_command", FLOAT, encode(FLOAT, {"data": 0.01 * (1 + time)}), stamp)
            if row in (0, 12 * RATE):
                writer.write("/internal_leakage", FLOAT, encode(FLOAT, {"data": 1e-12 * (1 + time)}), stamp)
            joint = {"header": header(stamp), "name": ["piston"], "position": [0.01 * np.sin(time)]}
            writer.write("/joint_states", JOINTS, encode(JOINTS, joint), stamp)
            pressure = {"header": header(stamp), "fluid_pressure": 1e7 + row}
            writer.write("/chamber_a/pressure", PRESSURE, encode(PRESSURE, pressure), stamp)
    return file


def taken(source: Blocks, wanted: frozenset[int] | None = None) -> list[Block]:
    found: list[Block] = []
    source.each(found.append, wanted)
    return found


def recordings_of(source: Blocks) -> list[Recording]:
    found = [one.recording for one in taken(source)]
    assert all(found)
    return [one for one in found if one]


@pytest.mark.parametrize("piece", [0.5, 4.0, 1000.0])
def test_blocks_of_a_file_are_those_of_the_recording(path: Path, piece: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "PIECE", piece)
    whole = read_recording(path)
    read, cut = recordings_of(BlocksOfFile(path, None, 5.0)), recordings_of(BlocksInMemory(whole, 5.0))
    assert len(read) == len(cut) == 5
    for one, other in zip(read, cut, strict=True):
        assert one.path == other.path
        assert one.start_stamp == other.start_stamp
        assert one.duration == pytest.approx(other.duration, abs=1e-9)
        assert one.parameters == other.parameters == whole.parameters
        np.testing.assert_allclose(one.leakage_changes, other.leakage_changes, rtol=0, atol=1e-9)
        assert list(one.channels) == list(other.channels)
        for name in one.channels:
            np.testing.assert_allclose(one.channels[name].time, other.channels[name].time, rtol=0, atol=1e-9)
            np.testing.assert_array_equal(one.channels[name].values, other.channels[name].values)
    assert sum(len(one.channels["position"].time) for one in read) == len(whole.channels["position"].time)


def test_what_held_when_a_block_began_holds_in_it(path: Path) -> None:
    second = recordings_of(BlocksOfFile(path, None, 5.0))[1]
    command = second.channels["voltage_command"]
    np.testing.assert_allclose(command.time, [0.0, 2.0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(command.values, [0.01, 0.08])


@pytest.mark.parametrize("length", [4.99, 7.0])
def test_every_sample_is_in_one_block(path: Path, length: float) -> None:
    """Blocks that begin between two samples, and with a change of the command."""
    whole, read = read_recording(path), recordings_of(BlocksOfFile(path, None, length))
    for name in ("position", "pressure_a"):
        values = np.concatenate([one.channels[name].values for one in read])
        np.testing.assert_array_equal(values, whole.channels[name].values)
    for one in read:
        assert one.channels["voltage_command"].time[0] == pytest.approx(0.0, abs=1e-9)
        assert np.all(np.diff(one.channels["voltage_command"].time) > 0.0)


def test_the_leakage_counts_from_the_record_and_not_from_the_block() -> None:
    changes = ((0.0, 1e-12), (12.0, 5e-12), (21.0, 9e-12))
    assert leakage_within((), 3.0, 8.0) == ()
    assert leakage_within(changes, 0.0, 10.0) == ((0.0, 1e-12),)
    assert leakage_within(changes, 10.0, 20.0) == ((0.0, 1e-12), (2.0, 5e-12))
    (start, first), (soon, second), (later, third) = leakage_within(changes, 20.0, 30.0)
    assert (start, first, second, later, third) == (0.0, 1e-12, 5e-12, 1.0, 9e-12)
    assert 0.0 < soon < 1e-6


def test_only_what_is_wanted_is_handed_on(path: Path) -> None:
    for source in (BlocksOfFile(path, None, 5.0), BlocksInMemory(read_recording(path), 5.0)):
        assert [one.number for one in taken(source, frozenset({1, 4}))] == [1, 4]
        assert source.duration == pytest.approx(SECONDS)


def test_a_block_in_a_gap_says_that_nothing_is_there(path: Path) -> None:
    """Of what is measured; a command that holds on fills any gap."""
    whole = read_recording(path)
    position = whole.channels["position"]
    outside = (position.time < 4.0) | (position.time > 11.0)
    halves = replace(position, time=position.time[outside], values=position.values[outside])
    found = taken(BlocksInMemory(replace(whole, channels={"position": halves}), 5.0))
    assert [bool(one.recording) for one in found] == [True, False, True, True, True]
    assert [one.problem for one in found if one.recording] == [""] * 4
    assert found[1].problem == f"{whole.path}: no samples there"


def test_no_more_is_held_than_pieces(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of any length passes in pieces: between two of them never more than two blocks' samples are kept."""
    monkeypatch.setattr(blocks, "PIECE", 2.0)
    held: list[int] = []
    add = blocks._Cutter.add

    def counted(self: blocks._Cutter, *arguments: object) -> None:
        add(self, *arguments)  # type: ignore[arg-type]
        held.append(max(len(one.stamps) for one in self._pending.values()))

    monkeypatch.setattr(blocks._Cutter, "add", counted)
    taken(BlocksOfFile(path, None, 2.0))
    assert len(held) > 5
    assert max(held) <= 3 * 2.0 * RATE + RATE + 1


def test_a_file_that_was_cut_off_gives_what_is_there(path: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    source = BlocksOfFile(cut, None, 5.0)
    read = taken(source)
    assert 5.0 < source.duration < SECONDS
    assert source.damaged and f"what was read covers {source.duration:.4g} s" in source.damaged
    assert read[0].recording and read[0].recording.duration == pytest.approx(4.98)


def test_a_file_without_a_channel_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "none.mcap"
    with RecordingWriter(file) as writer:
        writer.write("/chatter", FLOAT, encode(FLOAT, {"data": 1.0}), START)
    with pytest.raises(RecordingError, match="no usable channel"):
        taken(BlocksOfFile(file, None, 5.0))


def test_beyond_the_end_nothing_was_measured(path: Path) -> None:
    """What held last goes on holding; no sample of another channel is there."""
    beyond = cut_out(read_recording(path), 500.0, 510.0)
    assert beyond is not None
    assert list(beyond.channels) == ["voltage_command"]


def a_rig(
    file: Path, times: list[float], command_at: tuple[float, ...] = (0.0,), flush_at: tuple[float, ...] = ()
) -> Path:
    """Positions at the times [s], each the time in mm, and commands of as many mV."""
    with RecordingWriter(file, flush_period=1e9) as writer:
        for time in times:
            stamp = START + round(time * 1e9)
            if time in flush_at:
                writer.flush()
            if time in command_at:
                writer.write("/voltage_command", FLOAT, encode(FLOAT, {"data": time * 1e-3}), stamp)
            joint = {"header": header(stamp), "name": ["piston"], "position": [time * 1e-3]}
            writer.write("/joint_states", JOINTS, encode(JOINTS, joint), stamp)
    return file


@pytest.mark.parametrize("is_read", [True, False])
@pytest.mark.parametrize(
    ("last", "ends"), [(8, [2.5, 5.0, 7.5, 8.0]), (10, [2.5, 5.0, 7.5, 10.0]), (5, [2.5, 5.0]), (2, [2.0])]
)
def test_the_last_sample_is_in_the_last_block_also_where_the_record_ends_with_it(
    tmp_path: Path, is_read: bool, last: int, ends: list[float]
) -> None:
    file = a_rig(tmp_path / "run.mcap", [0.5 * k for k in range(2 * last + 1)])
    found = taken(BlocksOfFile(file, None, 2.5) if is_read else BlocksInMemory(read_recording(file), 2.5))
    assert [one.number for one in found] == list(range(len(ends)))
    assert [one.start for one in found] == pytest.approx([2.5 * k for k in range(len(ends))])
    assert [one.end for one in found] == pytest.approx(ends)
    for one in found:
        assert one.recording
        times = [time for time in np.arange(2 * last + 1) / 2 if one.start <= time < one.end or time == one.end == last]
        np.testing.assert_allclose(one.recording.channels["position"].values, np.array(times) * 1e-3)
        assert one.recording.channels["voltage_command"].values.tolist() == [0.0]
        assert one.recording.start_stamp == START + round(one.start * 1e9)


@pytest.mark.parametrize("is_read", [True, False])
def test_a_command_at_the_very_start_of_a_block_stands_for_itself(tmp_path: Path, is_read: bool) -> None:
    file = a_rig(tmp_path / "run.mcap", [0.5 * k for k in range(21)], (0.0, 1.0, 5.0, 6.5, 8.5, 10.0))
    found = recordings_of(BlocksOfFile(file, None, 5.0) if is_read else BlocksInMemory(read_recording(file), 5.0))
    commands = [one.channels["voltage_command"] for one in found]
    assert [one.time.tolist() for one in commands] == [[0.0, 1.0], [0.0, 1.5, 3.5, 5.0]]
    np.testing.assert_allclose(commands[1].values, [5e-3, 6.5e-3, 8.5e-3, 10e-3])


def test_a_gap_longer_than_blocks_has_blocks_without_samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "PIECE", 1.0)
    times = [0.0, 0.5, 1.0, 9.25, 9.5, 10.0]
    file = a_rig(tmp_path / "run.mcap", times, flush_at=(9.25, 9.5, 10.0))
    found = taken(BlocksOfFile(file, None, 2.0))
    assert [bool(one.recording) for one in found] == [True, False, False, False, True]
    assert found[1].problem == f"{file} from 2 s to 4 s: no samples there"
    assert [one.problem for one in found if one.recording] == ["", ""]
    last = found[4].recording
    assert last and last.channels["voltage_command"].time.tolist() == [0.0]
    np.testing.assert_allclose(last.channels["position"].time, [1.25, 1.5, 2.0])


def test_what_was_left_out_in_several_pieces_is_said_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "PIECE", 2.0)
    file = tmp_path / "run.mcap"
    with RecordingWriter(file, flush_period=1e9) as writer:
        for k in range(100):
            writer.flush() if k % 10 == 0 else None
            stamp = START + k * 100_000_000
            place = np.nan if k % 25 == 5 else k * 1e-3
            joint = {"header": header(stamp), "name": ["piston"], "position": [place]}
            writer.write("/joint_states", JOINTS, encode(JOINTS, joint), stamp)
    source = BlocksOfFile(file, None, 2.0)
    kept = np.concatenate([one.channels["position"].values for one in recordings_of(source)])
    np.testing.assert_allclose(kept, [k * 1e-3 for k in range(100) if k % 25 != 5])
    (remark,) = source.remarks
    assert remark.startswith("position (/joint_states): 1 samples that are not finite numbers were left out (and so ")
    assert remark.endswith("3 more places)")


def test_a_piece_that_goes_back_before_the_last_is_left_out_and_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stamps begin anew at 4 s by the recorder's clock; they are back where they were after 3 s."""
    monkeypatch.setattr(blocks, "PIECE", 1.0)
    file = tmp_path / "run.mcap"
    with RecordingWriter(file, flush_period=1e9) as writer:
        for k in range(80):
            writer.flush() if k % 10 == 0 else None
            time = 0.1 * k if k < 40 else 0.1 * k - 0.3
            joint = {"header": header(START + round(time * 1e9)), "name": ["piston"], "position": [k * 1e-3]}
            writer.write("/joint_states", JOINTS, encode(JOINTS, joint), START + k * 100_000_000)
    source = BlocksOfFile(file, None, 2.0)
    kept = np.concatenate([one.channels["position"].values for one in recordings_of(source)])
    np.testing.assert_allclose(kept, [k * 1e-3 for k in range(80) if not 40 <= k < 43])
    assert source.remarks == ("position: 3 samples were left out because time runs backwards there",)


def test_a_file_s_pieces_end_after_30_s_or_a_million_messages(monkeypatch: pytest.MonkeyPatch) -> None:
    gathered: list[int] = []

    def is_gathered(gate: blocks._Gate, log_time: int, count: int = 1) -> bool:
        before = len(gathered)
        gate.passes(log_time, count)
        return len(gathered) > before

    gate, second = blocks._Gate(lambda: gathered.append(1)), 10**9
    gathered = [is_gathered(gate, time) for time in (7, 30 * second, 30 * second + 6, 30 * second + 7, 31 * second)]
    assert gathered == [False, False, False, True, False]
    assert [is_gathered(gate, time) for time in (60 * second + 6, 60 * second + 7, 61 * second)] == [False, True, False]
    many = blocks._Gate(lambda: gathered.append(1))
    gathered = [is_gathered(many, 0, count) for count in (400_000, 600_000, 1, 999_999, 1, 7)]
    assert gathered == [False, False, True, False, True, False]
    far = blocks._Gate(lambda: gathered.append(1))
    assert [is_gathered(far, 0, count) for count in (1, 2_000_000)] == [False, True]


def test_progress_is_told_with_what_is_known(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(blocks, "PIECE", 10.0)
    source, gathered = BlocksOfFile(path, None, 5.0), list[str]()
    for _ in range(2):
        source.each(lambda block: None, None, gathered.append)
    assert gathered[-1] == "reading run.mcap: 23 of 23 s"
    assert gathered[len(gathered) // 2 - 1] == "reading run.mcap: 23 s"
    assert gathered[0] == "reading run.mcap: 10 s"
