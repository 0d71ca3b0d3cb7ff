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
    """Frequencies [Hz] and the periodogram there [unit^2] of the longest stretch without a gap, as even as white noise is.

    Samples whose stamps scatter are taken as evenly spaced: between them interpolated, their noise would not be white.
    """
    edges = np.concatenate([[0], np.flatnonzero(np.diff(signal.time) > GAP * signal.period) + 1, [len(signal.time)]])
    longest = int(np.argmax(np.diff(edges)))
    rough = np.diff(signal.values[edges[longest] : edges[longest + 1]], n=ORDER)
    rough = rough * tukey(len(rough), TAPERED)
    power = np.abs(np.fft.rfft(rough)) ** 2 / len(rough)
    frequency = np.fft.rfftfreq(len(rough), signal.period)
    passed = (2.0 * np.sin(np.pi * frequency * signal.period)) ** (2 * ORDER)
    return frequency, power / np.maximum(passed, 1e-300)
