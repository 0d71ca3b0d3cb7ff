"""A stretch cut out of a recording, with its own time and the values that were in force at its begin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from eha_core.recording.recording import Channel, FloatArray, Recording

HELD = ("voltage_command",)
"""Channels whose last value holds."""

JUST_AFTER = 1e-9
"""s; time in a stretch of a leakage change from before it: first of all, yet after its start, so that it is relative to
the coefficient at the start of the whole record."""


def named_stretch(path: Path, start: float, end: float) -> Path:
    """The name of a stretch [s of its record] in place of a path."""
    return Path(f"{path} from {start:.6g} s to {end:.6g} s")


def cut_out(recording: Recording, start: float, end: float) -> Recording | None:
    """The part of a recording from `start` up to `end` [s]; None where no channel has a sample there."""
    channels = {}
    for name, channel in recording.channels.items():
        first, last = (int(place) for place in np.searchsorted(channel.time, [start, end]))
        time, values = channel.time[first:last], channel.values[first:last]
        if name in HELD and first > 0 and not (len(time) and time[0] == start):
            time = np.concatenate([[start], time])
            values = np.concatenate([channel.values[first - 1 : first], values])
        if len(time):
            channels[name] = (channel, time, values)
    if not channels:
        return None
    begin = min(float(time[0]) for _, time, _ in channels.values())
    duration = max(float(time[-1]) for _, time, _ in channels.values()) - begin
    return replace(
        recording,
        path=named_stretch(recording.path, start, end),
        channels={name: _moved(channel, time - begin, values) for name, (channel, time, values) in channels.items()},
        start_stamp=recording.start_stamp + round(begin * 1e9),
        duration=duration,
        leakage_changes=leakage_within(recording.leakage_changes, begin, begin + duration),
        remarks=(),
    )


def leakage_within(changes: Sequence[tuple[float, float]], start: float, end: float) -> tuple[tuple[float, float], ...]:
    """The internal leakage of a stretch: the coefficient at the record's start, then the one in force at the stretch's
    start, then its own changes, in its own time."""
    before = [value for time, value in changes if time <= start]
    if not changes:
        return ()
    initial = next((value for time, value in reversed(changes) if time <= 0.0), changes[0][1])
    in_force = before[-1] if before else initial
    within = [(0.0, initial)]
    if in_force != initial:
        within.append((JUST_AFTER, in_force))
    return (*within, *((time - start, value) for time, value in changes if start < time < end))


def _moved(channel: Channel, time: FloatArray, values: FloatArray) -> Channel:
    time.flags.writeable = values.flags.writeable = False
    return replace(channel, time=time, values=values)
