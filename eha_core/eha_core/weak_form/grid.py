"""The places of the weak form's test functions in a recording, and which of them contain no gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.identification.numbers import Array
from eha_core.identification.observation import Measured
from eha_core.weak_form.weighting import HALF_WIDTH, weighting

HOPS = 4
"""Test functions that begin within the length of one: 33 per second, so that a force of 10 Hz is not aliased."""

GAP = 0.01
"""s; longest gap of a channel under a test function: a longer straight line is not a measurement."""


@dataclass(frozen=True)
class Grid:
    """An even grid of times [s], and a test function with its derivatives on it; `gap_free` flags the places without a
    gap of any channel under it."""

    time: Array
    step: float
    gap_free: NDArray[np.bool_]
    weight: Array
    slope: Array
    curvature: Array

    @property
    def area(self) -> float:
        """The test function's integral [s]."""
        return float(np.sum(self.weight)) * self.step

    def integrate(self, weight: Array, values: Array) -> Array:
        """The integral of weight times values (..., times) about each centre."""
        windows = np.lib.stride_tricks.sliding_window_view(values, len(weight), axis=-1)
        sums = windows[..., :: len(weight) // HOPS, :] @ weight
        return np.asarray(sums[..., self.gap_free]) * self.step

    def average(self, values: Array) -> Array:
        """The weighted mean of values (..., times) about each centre."""
        return self.integrate(self.weight, values) / self.area

    def centres(self) -> Array:
        """Times of the test functions' centres."""
        half = len(self.weight) // 2
        return self.time[half : len(self.time) - half][:: len(self.weight) // HOPS][self.gap_free]


def make_grid(duration: float, step: float, channels: Sequence[Measured], half_width: float = HALF_WIDTH) -> Grid:
    """Test functions of `half_width` [s] over the whole duration [s], on a grid of `step` [s], for channels that may
    have gaps."""
    sampled = weighting(step, half_width)
    half = len(sampled.weight) // 2
    time = np.asarray(np.arange(0.0, duration, step), dtype=np.float64)
    centres = time[half : len(time) - half][:: len(sampled.weight) // HOPS]
    gap_free = np.all([_measured_about(channel, centres, half * step, step) for channel in channels], axis=0)
    return Grid(time, step, gap_free, *sampled)


def _measured_about(channel: Measured, centres: Array, width: float, step: float) -> NDArray[np.bool_]:
    """Whether a channel has no gap within `width` of each centre."""
    times = np.concatenate([[-np.inf], channel.time, [np.inf]])
    wide = np.flatnonzero(np.diff(times) > max(GAP, 2.5 * step))
    ends_before = np.searchsorted(times[wide + 1], centres - width)
    starts_before = np.searchsorted(times[wide], centres + width)
    return np.asarray(ends_before == starts_before)
