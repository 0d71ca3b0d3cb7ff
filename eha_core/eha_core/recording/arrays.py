"""A recording from arrays or a data frame, checked and converted to the model's units like one from a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eha_core.errors import RecordingError, remedy
from eha_core.recording.assembly import Assembled, assembled
from eha_core.recording.channel_kinds import CHANNEL_KINDS, FloatArray
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, ChannelRule
from eha_core.recording.raw import RawRecording
from eha_core.recording.samples import Samples

IN_MEMORY = "in memory"
"""In place of the path of a recording that is not in a file."""


def from_arrays(
    time: ArrayLike, channels: Mapping[str, ArrayLike], pressures: str = ABSOLUTE, name: str = IN_MEMORY
) -> Assembled:
    """See `Recording.from_arrays`."""
    if pressures not in (ABSOLUTE, GAUGE):
        raise RecordingError(f"{name}: pressures = {pressures!r}; say {ABSOLUTE!r} or {GAUGE!r}")
    if not channels:
        raise RecordingError(f"{name}: no channel was given; channels are {', '.join(CHANNEL_KINDS)}")
    seconds = _vector(name, "time", time)
    if not np.all(np.isfinite(seconds)):
        raise RecordingError(f"{name}: time has values that are not numbers; give every sample its time in s")
    stamps = np.round(seconds * 1e9).astype(np.int64)
    rules, samples = {}, {}
    for channel, values in channels.items():
        if channel not in CHANNEL_KINDS:
            raise RecordingError(f"{name}: {channel!r} is not a channel; {remedy(channel, CHANNEL_KINDS)}")
        column = _vector(name, channel, values)
        if len(column) != len(seconds):
            raise RecordingError(
                f"{name}: {channel} has {len(column)} values and time {len(seconds)}; give one value for each time"
            )
        is_pressure = CHANNEL_KINDS[channel].is_pressure
        rules[channel] = ChannelRule(channel, column=channel, reference=pressures if is_pressure else None)
        samples[channel] = Samples(stamps, column)
    return assembled(Path(name), samples, rules, dict.fromkeys(rules, "array"), RawRecording(), [])


def from_dataframe(
    frame: Any, columns: Mapping[str, str], time: str | None, pressures: str = ABSOLUTE, name: str = IN_MEMORY
) -> Assembled:
    """See `Recording.from_dataframe`."""
    there = [str(column) for column in frame.columns]
    wanted = {channel: channel for channel in CHANNEL_KINDS} | dict(columns)
    missing = next((column for column in (*columns.values(), *([time] if time else [])) if column not in there), None)
    if missing is not None:
        raise RecordingError(f"{name}: there is no column {missing!r}; the columns are {', '.join(there)}")
    found = {channel: frame[column] for channel, column in wanted.items() if column in there}
    return from_arrays(_seconds(frame, time, there, name), found, pressures, name)


def _seconds(frame: Any, time: str | None, there: list[str], name: str) -> FloatArray:
    """The times [s]: a named column, the column `time`, or the frame's index; dates count from the first."""
    if time is None and "time" not in there and not hasattr(frame, "index"):
        raise RecordingError(f"{name}: no column `time`; name the one that holds the times [s] with time=")
    values = np.asarray(frame[time or "time"] if time or "time" in there else frame.index)
    if values.dtype.kind in "mM":
        return np.asarray((values - values[0]) / np.timedelta64(1, "ns") * 1e-9, dtype=np.float64)
    return _vector(name, time or "time", values)


def _vector(name: str, what: str, values: ArrayLike) -> FloatArray:
    try:
        vector = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise RecordingError(f"{name}: {what} has values that are not numbers") from None
    if vector.ndim != 1 or not len(vector):
        raise RecordingError(f"{name}: {what} has the shape {vector.shape}; give one number for each time")
    return vector
