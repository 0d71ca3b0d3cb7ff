"""A recording's channels on one grid, smoothed alike, with the piston's speed and acceleration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.ndimage import uniform_filter1d

from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

SMOOTHED_OVER = 0.05
"""s; window of each of three moving averages: long for a sensor's noise, short for a piston's motion."""
FEWEST_SAMPLES = 5
"""Fewest samples of that window, for a slowly sampled recording."""
LARGEST_NOISE = 0.5
"""Largest share of noise in the speed's standard deviation for the motion to count as visible."""
FINEST_STEP = 1e-3
"""s; signs and scales need no finer grid."""
BLOCK = 2.0
"""s; length of the blocks that are compared one by one, so that contact with a stop or a change of load affects only
its own."""
LARGEST_GRID = 200_000
"""Most samples of a long recording's grid."""


@dataclass(frozen=True)
class Signals:
    """`channels` by name, `speed` [m/s] and `acceleration` [m/s^2] of the position, all (n,) and `step` [s] apart;
    `speed_noise` [m/s]: standard deviation of the position sensor's noise in the speed; `noise`: that of each channel.
    """

    step: float
    channels: Mapping[str, FloatArray]
    speed: FloatArray
    acceleration: FloatArray
    speed_noise: float
    noise: Mapping[str, float]

    @property
    def is_motion_seen(self) -> bool:
        """Whether the speed exceeds its noise: a piston held by friction or a dead band gives no information."""
        return bool(self.speed_noise < LARGEST_NOISE * np.std(self.speed))


def on_grid(recording: Recording) -> Signals | None:
    """The channels over the time when all of them were recorded; None without a position, or with too little of it."""
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

    def speed_of(position: FloatArray) -> FloatArray:
        return np.asarray(np.gradient(smooth(position, 1), step))

    speed = speed_of(raw["position"])
    acceleration = np.gradient(smooth(speed, 1), step)
    stride = width // FEWEST_SAMPLES  # smoothed signals need no more samples
    inside = slice(2 * width, -2 * width, stride)
    impulse = _impulse(width)
    passed = float(np.linalg.norm(smooth(impulse)))
    return Signals(
        stride * step,
        {name: smooth(values)[inside] for name, values in raw.items()},
        smooth(speed, 2)[inside],
        smooth(acceleration, 1)[inside],
        _noise(recording.channels["position"].values) * float(np.linalg.norm(smooth(speed_of(impulse), 2))),
        {name: passed * _noise(channel.values) for name, channel in recording.channels.items()},
    )


def _noise(values: FloatArray) -> float:
    """Standard deviation of a channel's noise, from its roughness."""
    return float(np.std(np.diff(values, 2))) / sqrt(6.0) if len(values) > 2 else 0.0


def _impulse(width: int) -> FloatArray:
    """A unit impulse: the root of a filter's response energy is the ratio of output to input noise."""
    impulse = np.zeros(8 * width)
    impulse[4 * width] = 1.0
    return impulse
