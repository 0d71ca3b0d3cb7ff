"""Mains hum on a sensor's cable.

It is a line at 50 or 60 Hz that stands out of the neighbouring spectrum. The power of noise in a line is exponentially
distributed: one of the lines in the band has FAR times the mean once in 1e12 recordings. A line that the command also
has is the rig's response. The line is subtracted from the channel.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import block_means
from eha_core.health.signal import Signal
from eha_core.health.spectrum import lines
from eha_core.recording.recording import FloatArray

MAINS = (50.0, 60.0)
"""Hz."""
OFF = 0.25
"""Hz; tolerance of the mains' frequency and of a logger's clock."""
BESIDE = (1.0, 6.0)
"""Hz; distance of the neighbouring spectrum from the line."""
FAR = 60.0
"""Power of a line, over the mean next to it (noise: exp(-60) per line; assumed of a rig's motion at these
frequencies)."""
HIGHEST = 0.45
"""Highest frequency of a line that is not an alias, as a share of the sampling rate."""


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
    """The channel minus a sine of about this frequency, fitted to second differences, which hardly show motion.

    They are taken of means over a quarter of a period: of single samples they are nearly all noise of high frequencies.
    """
    group = max(1, int(0.25 / (frequency * signal.period)))

    def rough(values: FloatArray) -> FloatArray:
        return np.asarray(np.diff(block_means(values, group), n=2, axis=0))

    def waves(at: float) -> FloatArray:
        phase = 2.0 * np.pi * at * signal.time
        return np.stack([np.cos(phase), np.sin(phase)], axis=1)

    wanted, reach = rough(signal.values), 1.0 / (signal.time[-1] - signal.time[0])
    within = (frequency - reach, frequency + reach)
    best = minimize_scalar(lambda at: np.linalg.lstsq(rough(waves(at)), wanted)[1][0], bounds=within, method="bounded")
    sizes = np.linalg.lstsq(rough(waves(best.x)), wanted)[0]
    fault = Fault(
        signal.name, "hum", float(signal.time[0]), float(signal.time[-1]),
        f"hums at {best.x:.4g} Hz with {np.hypot(*sizes):.3g} {signal.channel.unit}",
        "shield and ground its cable", False,
    )  # fmt: skip
    values = signal.channel.values.copy()
    values[signal.places] -= waves(best.x) @ sizes
    return Found([fault], np.zeros(len(values), dtype=np.bool_), values)
