"""A channel that hums: the mains' frequency on a sensor's cable.

A line at 50 or 60 Hz that stands out of what is beside it. The power of noise in a line is exponential: of all the
lines within the band, one is FAR times the mean once in 1e12 recordings. What the command has as well, the rig answers
to. The line is taken out of the channel.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.signal import Signal
from eha_core.health.spectrum import lines

MAINS = (50.0, 60.0)
"""Hz."""
OFF = 0.25
"""Hz by which the mains may be off, and a logger's clock with it."""
BESIDE = (1.0, 6.0)
"""Hz from the line to what is beside it."""
FAR = 60.0
"""Times the mean power beside it (noise: exp(-60) a line; assumed of what a rig does at these frequencies)."""
HIGHEST = 0.45
"""Share of the sampling rate up to which a line is no mirror of another."""


def find(signal: Signal) -> Found | None:
    """The line, if there is one."""
    if signal.is_command or not signal.is_noisy:
        return None
    frequency, power = lines(signal)
    if frequency[0] > OFF:
        return None
    for mains in MAINS:
        away = np.abs(frequency - mains)
        beside = power[(away > BESIDE[0]) & (away < BESIDE[1])]
        inside = away < OFF
        if mains > HIGHEST / signal.period or not len(beside):
            continue
        highest = float(np.max(power[inside]))
        if highest > FAR * np.median(beside) / np.log(2.0) and highest > 2.0 * np.max(beside):
            return _without(signal, float(frequency[inside][np.argmax(power[inside])]))
    return None


def _without(signal: Signal, frequency: float) -> Found:
    """The channel less a sine of about this frequency, fitted to its differences."""
    best = None
    rough = np.diff(signal.values, n=2)
    for candidate in frequency + np.linspace(-0.5, 0.5, 11) / (signal.time[-1] - signal.time[0]):
        phase = 2.0 * np.pi * candidate * signal.time
        waves = np.stack([np.cos(phase), np.sin(phase)], axis=1)
        columns = np.diff(waves, n=2, axis=0)
        found = np.linalg.solve(columns.T @ columns, columns.T @ rough)
        rest = float(np.sum((rough - columns @ found) ** 2))
        if best is None or rest < best[0]:
            best = (rest, float(candidate), found, waves @ found)
    assert best is not None
    size = float(np.hypot(*best[2]))
    fault = Fault(
        signal.name, "hum", float(signal.time[0]), float(signal.time[-1]),
        f"hums at {best[1]:.4g} Hz with {size:.3g} {signal.channel.unit}", "shield and ground its cable", False,
    )  # fmt: skip
    values = signal.channel.values.copy()
    values[signal.places] -= best[3]
    return Found([fault], np.zeros(len(values), dtype=np.bool_), values)
