"""The spectrum of a channel's noise."""

from __future__ import annotations

import numpy as np
from scipy.signal.windows import tukey

from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

ORDER = 2
"""Order of the differences taken before the transform and undone in the spectrum: the motion, thousands of times the
noise, would leak into every frequency."""
GAP = 2.5
"""Periods between two samples from which one is missing between them."""
TAPERED = 0.2
"""Share of the recording that is tapered."""
SEGMENT = 64
"""Samples of a segment: short compared with the time between two reversals of the piston."""


def usual_spectrum(signal: Signal) -> tuple[FloatArray, FloatArray, int]:
    """Frequencies as shares of the highest one, the power there [unit^2], flat for white noise, and the number of
    segments. The power is a median over segments, so that brief roughness, as where friction breaks away, is ignored.

    Samples with jitter in their stamps are taken as evenly spaced, because interpolated noise would not be white.
    """
    whole = np.concatenate([[0], np.cumsum(np.diff(signal.time) > GAP * signal.period)])
    starts = np.arange(0, len(signal.values) - SEGMENT + 1, SEGMENT // 2)
    starts = starts[whole[starts] == whole[starts + SEGMENT - 1]]
    segments = signal.values[starts[:, None] + np.arange(SEGMENT)]
    rough = np.diff(segments, n=ORDER, axis=1) * np.hanning(SEGMENT - ORDER)
    share = np.arange(1, (SEGMENT - ORDER) // 2 + 1) / ((SEGMENT - ORDER) / 2.0)
    power = np.abs(np.fft.rfft(rough, axis=1)[:, 1:]) ** 2 / (2.0 * np.sin(0.5 * np.pi * share)) ** (2 * ORDER)
    return share, power, len(starts)


def lines(signal: Signal) -> tuple[FloatArray, FloatArray]:
    """Frequencies [Hz] and the periodogram [unit^2] of the whole recording; gaps are bridged."""
    places = np.round((signal.time - signal.time[0]) / signal.period).astype(np.int64)
    values = np.full(places[-1] + 1, np.nan)
    values[places] = signal.values
    rough = np.nan_to_num(np.diff(values, n=ORDER))
    rough = rough * tukey(len(rough), TAPERED)
    power = np.asarray(np.abs(np.fft.rfft(rough)) ** 2 / len(rough), dtype=np.float64)
    frequency = np.asarray(np.fft.rfftfreq(len(rough), signal.period), dtype=np.float64)
    passed = (2.0 * np.sin(np.pi * frequency * signal.period)) ** (2 * ORDER)
    return frequency[1:], power[1:] / passed[1:]
