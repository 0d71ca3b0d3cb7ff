"""A recording's channels on one grid, smoothed alike, with the piston's speed and acceleration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

SMOOTHED_OVER = 0.05
"""s; each of three passes averages over so much: long against a sensor's noise, short against a piston's motion."""
FEWEST_SAMPLES = 5
"""Samples that each pass averages over at least, where a recording is sampled slowly."""
FINEST_STEP = 1e-3
"""s; signs and scales need no finer grid."""
LARGEST_GRID = 200_000
"""Samples that a long recording's grid has at most."""


@dataclass(frozen=True)
class Signals:
    """`channels` by name, `speed` [m/s] and `acceleration` [m/s^2] of the position, all (n,) and `step` [s] apart."""

    step: float
    channels: Mapping[str, FloatArray]
    speed: FloatArray
    acceleration: FloatArray


def on_grid(recording: Recording) -> Signals | None:
    """The channels where all of them were recorded; None without a position, or with too little of it."""
    if "position" not in recording.channels:
        return None
    start = max(channel.time[0] for channel in recording.channels.values())
    end = min(channel.time[-1] for channel in recording.channels.values())
    interval = float(np.median(np.diff(recording.channels["position"].time))) if end > start else np.inf
    step = max(interval, FINEST_STEP, (end - start) / LARGEST_GRID)
    width = max(FEWEST_SAMPLES, round(SMOOTHED_OVER / step))
    if not end - start > 12 * width * step:
        return None
    time = np.arange(start, end, step)

    def smooth(values: FloatArray, passes: int = 3) -> FloatArray:
        for _ in range(passes):
            values = uniform_filter1d(values, width, mode="nearest")
        return values

    raw = {name: np.interp(time, channel.time, channel.values) for name, channel in recording.channels.items()}
    speed = np.gradient(smooth(raw["position"], 1), step)
    acceleration = np.gradient(smooth(speed, 1), step)
    stride = width // FEWEST_SAMPLES  # what is smoothed needs no more
    inside = slice(2 * width, -2 * width, stride)
    return Signals(
        stride * step,
        {name: smooth(values)[inside] for name, values in raw.items()},
        smooth(speed, 2)[inside],
        smooth(acceleration, 1)[inside],
    )
