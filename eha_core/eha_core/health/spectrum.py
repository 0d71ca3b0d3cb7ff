"""The spectrum of a channel's noise."""

from __future__ import annotations

import numpy as np
from scipy.signal.windows import tukey

from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

ORDER = 2
"""Of the differences that are taken first and undone in the spectrum: the motion, thousands of times the noise, would
leak into every frequency."""
TAPERED = 0.2
"""Share of the stretch over which it begins and ends."""
INDEPENDENT = 0.9
"""Share of the lines that are independent after that."""
GAP = 2.5
"""Periods from one sample to the next from which on one is missing between them."""


def spectrum(signal: Signal) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and the periodogram [unit^2], as even as white noise is, of the longest stretch without a gap.

    Samples whose stamps scatter are taken as evenly spaced: between them interpolated, their noise would not be white.
    """
    edges = np.concatenate([[0], np.flatnonzero(np.diff(signal.time) > GAP * signal.period) + 1, [len(signal.time)]])
    longest = int(np.argmax(np.diff(edges)))
    return _periodogram(np.diff(signal.values[edges[longest] : edges[longest + 1]], n=ORDER), signal.period)


def with_gaps(signal: Signal) -> tuple[FloatArray, FloatArray]:
    """The same of all samples: its lines are as narrow as the recording is long, what lies between is less even."""
    places = np.round((signal.time - signal.time[0]) / signal.period).astype(np.int64)
    values = np.full(places[-1] + 1, np.nan)
    values[places] = signal.values
    return _periodogram(np.nan_to_num(np.diff(values, n=ORDER)), signal.period)


def _periodogram(rough: FloatArray, period: float) -> tuple[FloatArray, FloatArray]:
    rough = rough * tukey(len(rough), TAPERED)
    power = np.asarray(np.abs(np.fft.rfft(rough)) ** 2 / len(rough), dtype=np.float64)
    frequency = np.asarray(np.fft.rfftfreq(len(rough), period), dtype=np.float64)
    passed = (2.0 * np.sin(np.pi * frequency * period)) ** (2 * ORDER)
    return frequency[1:], power[1:] / passed[1:]
