"""The spectrum of a channel's noise."""

from __future__ import annotations

import numpy as np

from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

ORDER = 4
"""Of the differences that are taken first and undone in the spectrum: the motion, a million times the noise, would
leak into every frequency."""


def spectrum(signal: Signal) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and the periodogram there [unit^2], as even as white noise is."""
    time = signal.time[0] + signal.period * np.arange(int((signal.time[-1] - signal.time[0]) / signal.period) + 1)
    values = signal.values if len(time) == len(signal.values) else np.interp(time, signal.time, signal.values)
    rough = np.diff(values, n=ORDER)
    rough = rough * np.hanning(len(rough))
    power = np.abs(np.fft.rfft(rough)) ** 2 / len(rough)
    frequency = np.fft.rfftfreq(len(rough), signal.period)
    passed = (2.0 * np.sin(np.pi * frequency * signal.period)) ** (2 * ORDER)
    return frequency, power / np.maximum(passed, 1e-300)
