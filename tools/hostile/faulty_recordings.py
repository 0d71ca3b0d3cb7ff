"""Recordings with a fault of their own: a sensor that freezes, a log with a hole, a channel that was held.

Each kind is made clearly, at twice or more of what can be detected, in recordings of simulated rigs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from eha_core.health import Fault
from eha_core.health.faults.spikes import FAR
from eha_core.health.noise import Flags
from eha_core.recording.reader import STANDARD_ATMOSPHERE
from eha_core.recording.recording import FloatArray
from tools.hostile.wrong_recordings import Arrays

Span = tuple[float, float]
Made = tuple[Arrays, tuple[Span, ...]]
Make = Callable[[Arrays, np.random.Generator], Made]
WHOLE: tuple[Span, ...] = ()
"""In place of spans: the fault is in all of the channel."""

CLEAR = 4.0
"""Times the size of a spike that can be found: of half of the largest it is twice."""
OVERLAP = 0.5
"""Share of the time of either span that both have, from which on the span is right."""


@dataclass(frozen=True)
class FaultKind:
    """A kind of fault.

    Attributes:
        name: what it is.
        expected: the words under which it may be found.
        channel: in which channel.
        make: how it is made.
        refused: whether a recording with it cannot be diagnosed.
        effects: effects of the catalogue that are this very fault, as a filter is a sensor's lag.
    """

    name: str
    expected: tuple[str, ...]
    channel: str
    make: Make
    refused: bool = False
    effects: tuple[str, ...] = ()


def _span(time: FloatArray, chance: np.random.Generator, length: float) -> Span:
    start = float(chance.uniform(0.15, 0.6) * time[-1])
    return start, start + min(length, 0.3 * float(time[-1]))


def _within(time: FloatArray, span: Span) -> Flags:
    return (time >= span[0]) & (time <= span[1])


def _hole(names: tuple[str, ...], length: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        span = _span(arrays[names[0]][0], chance, length)
        changed = dict(arrays)
        for name in names:
            time, values = changed[name]
            kept = ~_within(time, span)
            changed[name] = (time[kept], values[kept])
        return changed, (span,)

    return make


def _dropouts(arrays: Arrays, chance: np.random.Generator) -> Made:
    time, values = arrays["voltage_command"]
    kept, spans = np.ones(len(time), dtype=bool), []
    for start in np.sort(chance.uniform(0.3, time[-1] - 0.3, max(2, round(2.0 * time[-1])))):
        kept &= ~_within(time, (start, start + 0.05))
        spans.append((float(start), float(start) + 0.05))
    return {**arrays, "voltage_command": (time[kept], values[kept])}, tuple(spans)


def _lost_at_the_end(arrays: Arrays, chance: np.random.Generator) -> Made:
    time, values = arrays["voltage_command"]
    kept = time < 0.75 * time[-1]
    return {**arrays, "voltage_command": (time[kept], values[kept])}, ((0.75 * float(time[-1]), float(time[-1])),)


def _frozen(name: str, length: float = 1.5) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        span = _moving_span(arrays, chance, length)
        inside = np.flatnonzero(_within(time, span))
        frozen = values.copy()
        frozen[inside] = values[inside[0]]
        return {**arrays, name: (time, frozen)}, (span,)

    return make


def _moving_span(arrays: Arrays, chance: np.random.Generator, length: float) -> Span:
    """Of some spans that in which the piston moves most."""
    time, values = arrays["position"]
    spans = [_span(time, chance, length) for _ in range(5)]
    return max(spans, key=lambda span: float(np.ptp(values[_within(time, span)])))


def _dies(name: str, value: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        start = float(chance.uniform(0.6, 0.8) * time[-1])
        return {**arrays, name: (time, np.where(time >= start, value, values))}, ((start, float(time[-1])),)

    return make


def _held(name: str, seconds: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        every = max(2, round(seconds / float(np.median(np.diff(time)))))
        return {**arrays, name: (time, values[np.arange(len(values)) // every * every])}, WHOLE

    return make


def _interpolated(name: str, seconds: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        every = max(2, round(seconds / float(np.median(np.diff(time)))))
        return {**arrays, name: (time, np.interp(time, time[::every], values[::every]))}, WHOLE

    return make


def _clipped(name: str, share: float) -> Make:
    """Cut off at the level that so large a share of the samples exceeds."""

    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        level = float(np.quantile(values, 1.0 - share))
        return {**arrays, name: (time, np.minimum(values, level))}, _spans_of(time, values > level)

    return make


def _spans_of(time: FloatArray, flags: Flags) -> tuple[Span, ...]:
    places = np.flatnonzero(flags)
    pieces = np.split(places, np.flatnonzero(np.diff(time[places]) > 0.05) + 1)
    return tuple((float(time[piece[0]]), float(time[piece[-1]])) for piece in pieces if len(piece))


def _filled(name: str, value: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        filled, spans = values.copy(), []
        for start in np.sort(chance.uniform(0.1, 0.8, 4)) * time[-1]:
            span = (float(start), float(start) + 0.04)
            filled[_within(time, span)] = value
            spans.append(span)
        return {**arrays, name: (time, filled)}, tuple(spans)

    return make


def _wrapped(arrays: Arrays, chance: np.random.Generator) -> Made:
    time, values = arrays["position"]
    level = float(np.quantile(values, 0.7))
    modulus = 1.2 * float(np.ptp(values))
    return {**arrays, "position": (time, np.where(values > level, values - modulus, values))}, ()


def _leaps(change: Callable[[FloatArray], FloatArray], name: str) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        start = float(chance.uniform(0.6, 0.75) * time[-1])
        return {**arrays, name: (time, np.where(time >= start, change(values), values))}, ((start, float(time[-1])),)

    return make


def _by_a_quarter(values: FloatArray) -> FloatArray:
    return np.asarray(values + 0.5 * np.ptp(values))


def _times(factor: float, zero: float = 0.0) -> Callable[[FloatArray], FloatArray]:
    return lambda values: np.asarray(factor * (values + zero) - zero)


def _spikes(name: str) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        spiked = values.copy()
        places = chance.choice(np.arange(20, len(values) - 20), 12, replace=False)
        size = max(float(np.ptp(values)), CLEAR * FAR * _noise(values))
        spiked[places] += chance.choice((-1.0, 1.0), len(places)) * chance.uniform(0.5, 1.0, len(places)) * size
        return {**arrays, name: (time, spiked)}, WHOLE

    return make


def _noise(values: FloatArray) -> float:
    return float(np.std(np.diff(values, 4)) / np.sqrt(70.0))


def _hum(name: str, level: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        noise = _noise(values)
        return {**arrays, name: (time, values + level * noise * np.sin(2.0 * np.pi * 50.0 * time))}, WHOLE

    return make


def _low_passed(name: str, frequency: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        kept = float(np.exp(-2.0 * np.pi * frequency * np.median(np.diff(time))))
        passed, _ = lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * values[0]])
        return {**arrays, name: (time, passed)}, WHOLE

    return make


def _noisy(name: str) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        time, values = arrays[name]
        span = _span(time, chance, 1.0)
        noise = 20.0 * _noise(values)
        disturbed = values + np.where(_within(time, span), noise * chance.standard_normal(len(values)), 0.0)
        return {**arrays, name: (time, disturbed)}, (span,)

    return make


def _slow(rate: float) -> Make:
    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        thinned = {}
        for name, (time, values) in arrays.items():
            every = max(2, round(1.0 / rate / float(np.median(np.diff(time)))))
            thinned[name] = (time[::every], values[::every])
        return thinned, WHOLE

    return make


def _blocked(arrays: Arrays, chance: np.random.Generator) -> Made:
    time, values = arrays["position"]
    noise = float(np.std(np.diff(values, 4))) / np.sqrt(70.0)
    return {**arrays, "position": (time, values[0] + noise * chance.standard_normal(len(values)))}, WHOLE


def _drifting(share: float) -> Make:
    """Every sensor stamped by a clock that runs faster than the command's by that share."""

    def make(arrays: Arrays, chance: np.random.Generator) -> Made:
        command, last = arrays["voltage_command"], arrays["voltage_command"][0][-1]
        late = {name: ((1.0 + share) * time, values) for name, (time, values) in arrays.items()}
        kept = {name: (time[time <= last], values[time <= last]) for name, (time, values) in late.items()}
        return {**kept, "voltage_command": command}, WHOLE

    return make


EVERY = ("voltage_command", "position", "pressure_a", "pressure_b")
VACUUM = -STANDARD_ATMOSPHERE
FAULTS = (
    FaultKind("hole of all channels", ("hole",), "voltage_command", _hole(EVERY, 2.0)),
    FaultKind("hole of the command", ("hole",), "voltage_command", _hole(("voltage_command",), 1.0)),
    FaultKind("command drops out, 50 ms", ("hole",), "voltage_command", _dropouts),
    FaultKind("command lost to the end", ("hole",), "voltage_command", _lost_at_the_end),
    FaultKind("hole of a sensor", ("hole",), "position", _hole(("position",), 1.5)),
    FaultKind("frozen position", ("frozen",), "position", _frozen("position")),
    FaultKind("frozen pressure", ("frozen",), "pressure_b", _frozen("pressure_b")),
    FaultKind("frozen command", ("frozen",), "voltage_command", _frozen("voltage_command")),
    FaultKind("position held, 20 ms", ("held",), "position", _held("position", 0.02)),
    FaultKind("pressure held, 10 ms", ("held",), "pressure_a", _held("pressure_a", 0.01)),
    FaultKind("position interpolated from 50 Hz", ("interpolated",), "position", _interpolated("position", 0.02)),
    FaultKind("pressure interpolated from 50 Hz", ("interpolated",), "pressure_a", _interpolated("pressure_a", 0.02)),
    FaultKind("command interpolated from 50 Hz", ("interpolated",), "voltage_command",
              _interpolated("voltage_command", 0.02), refused=True),
    FaultKind("position at the end of its range", ("saturated",), "position", _clipped("position", 0.15)),
    FaultKind("pressure at the end of its range", ("saturated",), "pressure_a", _clipped("pressure_a", 0.15)),
    FaultKind("command clipped in the log", ("saturated",), "voltage_command", _clipped("voltage_command", 0.15)),
    FaultKind("position drops to a fill value", ("dropped",), "position", _filled("position", -1.0)),
    FaultKind("pressure drops to zero", ("dropped",), "pressure_b", _filled("pressure_b", VACUUM)),
    FaultKind("command drops to a fill value", ("dropped",), "voltage_command", _filled("voltage_command", -10.0)),
    FaultKind("pressure sensor dies", ("dropped", "frozen"), "pressure_a", _dies("pressure_a", VACUUM)),
    FaultKind("position wraps", ("wrapped", "jump"), "position", _wrapped),
    FaultKind("zero of the position leaps", ("jump",), "position", _leaps(_by_a_quarter, "position")),
    FaultKind("position turns to mm", ("jump",), "position", _leaps(_times(1e3), "position")),
    FaultKind("pressure turns to kPa", ("jump",), "pressure_a",
              _leaps(_times(1e-3, STANDARD_ATMOSPHERE), "pressure_a")),
    FaultKind("scale of a pressure leaps by 4", ("jump",), "pressure_b", _leaps(_times(4.0), "pressure_b")),
    FaultKind("spikes in the position", ("spikes",), "position", _spikes("position")),
    FaultKind("spikes in a pressure", ("spikes",), "pressure_a", _spikes("pressure_a")),
    FaultKind("hum in the position", ("hum",), "position", _hum("position", 3.0)),
    FaultKind("hum in a pressure", ("hum",), "pressure_b", _hum("pressure_b", 3.0)),
    FaultKind("pressure low-passed at 25 Hz", ("low_passed",), "pressure_a", _low_passed("pressure_a", 25.0),
              effects=("pressure_sensor_lag",)),
    FaultKind("position low-passed at 25 Hz", ("low_passed",), "position", _low_passed("position", 25.0),
              effects=("position_sensor_lag",)),
    FaultKind("pressure disturbed", ("noisy",), "pressure_b", _noisy("pressure_b")),
    FaultKind("log of 20 Hz", ("too_slow",), "voltage_command", _slow(20.0), refused=True),
    FaultKind("clock of the sensors 2 % fast", ("clock",), "position", _drifting(0.02), refused=True),
    FaultKind("piston that does not move", ("still",), "position", _blocked, refused=True),
)  # fmt: skip
"""Faults that arise while a recording is made or exported, each in one channel."""


def overlap(found: tuple[Span, ...], made: tuple[Span, ...], time: FloatArray) -> float:
    """The time that both kinds of spans share, over the time that either has."""
    first, second = (
        np.any([_within(time, span) for span in spans], axis=0) if spans else np.zeros(len(time), dtype=bool)
        for spans in (found, made)
    )
    either = np.count_nonzero(first | second)
    return np.count_nonzero(first & second) / either if either else 0.0


def faulty(kind: FaultKind, arrays: Mapping[str, tuple[FloatArray, FloatArray]], seed: int) -> Made:
    """A recording's channels with a fault, and the spans that it has."""
    return kind.make(arrays, np.random.default_rng([seed, FAULTS.index(kind)]))


def verdict(kind: FaultKind, faults: Sequence[Fault], spans: tuple[Span, ...], time: FloatArray) -> str:
    """What came of a recording with a fault: whether it was found, with its channel and span."""
    own = [fault for fault in faults if fault.channel == kind.channel]
    named = [fault for fault in own if fault.fault in kind.expected]
    if not named:
        return f"reported as {own[0].fault}" if own else "not found"
    if spans and overlap(tuple(fault.span for fault in named), spans, time) < OVERLAP:
        return "found, with another span"
    return "found"
