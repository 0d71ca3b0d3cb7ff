"""A stretch of a recording: which samples, on which clock, and what was in force when it began."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from eha_core.recording import Recording
from eha_core.recording.cutting import cut_out, leakage_within, named_stretch
from eha_core.recording.recording import Channel

START = 1_700_000_000_000_000_000


def channel(name: str, time: list[float], values: list[float]) -> Channel:
    return Channel(name, np.array(time), np.array(values), "", f"/{name}", "csv")


def recorded(command: tuple[list[float], list[float]]) -> Recording:
    """A position each half second for 4 s, of the time's square, and a command."""
    time = [0.5 * k for k in range(9)]
    channels = {
        "voltage_command": channel("voltage_command", *command),
        "position": channel("position", time, [at**2 for at in time]),
    }
    changes = ((0.0, 1e-12), (1.0, 2e-12), (2.0, 3e-12))
    return Recording(Path("run.mcap"), channels, START, 4.0, {"moving_mass": 9.0}, changes, None, ("a remark",))


def lists(one: Channel) -> tuple[list[float], list[float]]:
    return one.time.tolist(), one.values.tolist()


def test_a_stretch_has_the_samples_from_its_start_up_to_its_end() -> None:
    cut = cut_out(recorded(([0.0, 1.75], [5.0, 6.0])), 1.5, 3.0)
    assert cut is not None
    assert lists(cut.channels["position"]) == ([0.0, 0.5, 1.0], [2.25, 4.0, 6.25])
    assert lists(cut.channels["voltage_command"]) == ([0.0, 0.25], [5.0, 6.0])
    assert (cut.start_stamp, cut.duration) == (START + 1_500_000_000, 1.0)
    assert (cut.parameters, cut.remarks, cut.path) == ({"moving_mass": 9.0}, (), Path("run.mcap from 1.5 s to 3 s"))
    assert cut.path == named_stretch(Path("run.mcap"), 1.5, 3.0)
    assert not any(one.time.flags.writeable or one.values.flags.writeable for one in cut.channels.values())


def test_a_stretch_that_begins_between_samples_counts_from_its_first() -> None:
    """The command holds from the very start; without one the first position makes the time's zero."""
    whole = recorded(([0.25], [5.0]))
    cut = cut_out(whole, 0.75, 2.0)
    assert cut is not None
    assert lists(cut.channels["voltage_command"]) == ([0.0], [5.0])
    assert lists(cut.channels["position"]) == ([0.25, 0.75], [1.0, 2.25])
    assert (cut.start_stamp, cut.duration) == (START + 750_000_000, 0.75)
    before = cut_out(whole, -1.0, 0.25)
    assert before is not None and list(before.channels) == ["position"]
    assert (before.start_stamp, before.duration) == (START, 0.0)
    late = cut_out(recorded(([3.0], [5.0])), 0.75, 2.0)
    assert late is not None and list(late.channels) == ["position"]
    assert lists(late.channels["position"]) == ([0.0, 0.5], [1.0, 2.25])
    assert late.start_stamp == START + 1_000_000_000


@pytest.mark.parametrize(
    ("start", "times", "values"),
    [
        (0.75, [0.0, 0.25, 0.5], [5.0, 6.0, 7.0]),  # the one before holds
        (1.0, [0.0, 0.25], [6.0, 7.0]),  # one at the start counts alone
        (1.3, [0.0], [7.0]),
        (0.0, [0.5, 1.0, 1.25], [5.0, 6.0, 7.0]),  # none before: nothing holds
    ],
)
def test_the_last_command_before_a_stretch_holds_in_it(start: float, times: list[float], values: list[float]) -> None:
    cut = cut_out(recorded(([0.5, 1.0, 1.25], [5.0, 6.0, 7.0])), start, 1.5)
    assert cut is not None
    time, held = lists(cut.channels["voltage_command"])
    assert (time, held) == (pytest.approx(times), values)


def test_where_no_channel_has_a_sample_there_is_no_stretch() -> None:
    whole = recorded(([3.0], [5.0]))
    assert cut_out(whole, 0.1, 0.4) is None
    assert cut_out(whole, 0.5, 0.5) is None


def test_the_leakage_of_a_stretch_is_told_within_its_samples() -> None:
    """From 1.5 s its samples end at 2.5 s: the change at 1 s is in force, that at 2 s is its own."""
    cut = cut_out(recorded(([0.0], [5.0])), 1.5, 3.0)
    assert cut is not None
    (begun, first), (soon, second), (own, third) = cut.leakage_changes
    assert (begun, first, second, own, third) == (0.0, 1e-12, 2e-12, 0.5, 3e-12)
    assert soon == 1e-9


A, B, C = 1e-12, 5e-12, 9e-12


@pytest.mark.parametrize(
    ("changes", "start", "end", "expected"),
    [
        (((2.0, A), (5.0, B)), 0.0, 10.0, ((0.0, A), (2.0, A), (5.0, B))),  # before its first word: what that says
        (((2.0, A), (5.0, B)), 1.0, 4.0, ((0.0, A), (1.0, A))),
        (((-2.0, A), (-1.0, B), (4.0, C)), 0.0, 3.0, ((0.0, B),)),  # the last before the record began
        (((-1.0, A), (0.0, B), (4.0, C)), 0.0, 3.0, ((0.0, B),)),  # or just then
        (((-1.0, A), (0.5, B)), 0.0, 3.0, ((0.0, A), (0.5, B))),
        (((0.0, A), (1.0, B)), 1.0, 3.0, ((0.0, A), (1e-9, B))),  # at the start: in force
        (((0.0, A), (3.0, B)), 1.0, 3.0, ((0.0, A),)),  # at the end: the next stretch's
        (((0.0, A), (1.0, B), (2.0, A)), 2.5, 3.0, ((0.0, A),)),  # turned back: as it began
    ],
)
def test_a_stretch_tells_what_was_in_force_and_what_changed(
    changes: tuple[tuple[float, float], ...], start: float, end: float, expected: tuple[tuple[float, float], ...]
) -> None:
    assert leakage_within(changes, start, end) == expected
