"""A fault of a recording: its channel, kind and time, and its consequence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from eha_core.health.noise import Flags
from eha_core.recording import Channel, Recording
from eha_core.recording.recording import FloatArray

FORGOTTEN = 0.1
"""s after which coil and spool no longer depend on an earlier voltage: ten times the time constants of the paper's
valve, 5.9 ms of its coil and 3.8 ms of its spool (assumed of other valves). By then the piston's state is fitted
again."""


@dataclass(frozen=True)
class Fault:
    """One fault of one channel over one span.

    Attributes:
        channel: its name.
        fault: the kind, in a word: "hole", "frozen", "held" ...
        start, end: when [s].
        seen: what was found there, in words, with its numbers.
        remedy: what the user can do about it.
        excludes: whether the channel's samples in the span are not used.
        refuses: whether the recording cannot be diagnosed.
    """

    channel: str
    fault: str
    start: float
    end: float
    seen: str
    remedy: str
    excludes: bool = True
    refuses: bool = False

    @property
    def span(self) -> tuple[float, float]:
        """Its begin and end [s]."""
        return self.start, self.end


@dataclass(frozen=True)
class Found:
    """The result of one check of a channel: its faults, flags of the samples (n,) not to be used, and the values (n,)
    without the fault, where it can be corrected."""

    faults: Sequence[Fault]
    lost: Flags
    values: FloatArray | None = None


@dataclass(frozen=True)
class Health:
    """The faults of a recording in the order of their channels, flags of each channel's lost samples (n,), and the
    values (n,) of those whose fault could be corrected."""

    faults: tuple[Fault, ...] = ()
    lost: Mapping[str, Flags] = field(default_factory=dict)
    values: Mapping[str, FloatArray] = field(default_factory=dict)

    def sound(self, channel: Channel) -> tuple[FloatArray, FloatArray]:
        """The times and values of a channel without lost samples, corrected where possible."""
        values = self.values.get(channel.name, channel.values)
        if channel.name not in self.lost:
            return channel.time, values
        return channel.time[~self.lost[channel.name]], values[~self.lost[channel.name]]

    def without_faults(self, recording: Recording) -> Recording:
        """The recording with each channel's sound samples only."""
        channels = {}
        for name, channel in recording.channels.items():
            time, values = self.sound(channel)
            channels[name] = replace(channel, time=time, values=values)
        return replace(recording, channels=channels)

    def unknown_of(self, driving: Sequence[str], end: float) -> tuple[tuple[float, float], ...]:
        """The intervals [s] up to `end` in which the plant's inputs, these channels, are not known, each extended by
        FORGOTTEN; sorted and disjoint."""
        spans: list[tuple[float, float]] = []
        for start, stop in sorted(fault.span for fault in self.faults if fault.excludes and fault.channel in driving):
            stop = min(stop + FORGOTTEN, end)
            if spans and start <= spans[-1][1] + FORGOTTEN:
                spans[-1] = (spans[-1][0], max(spans[-1][1], stop))
            else:
                spans.append((start, stop))
        return tuple(spans)
