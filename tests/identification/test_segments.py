"""Channels are followed as closely as their noise allows: sensors that lag start windows there."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.identification.observation import Measured
from eha_core.identification.segments import follow, smooth

TIME = np.arange(0.0, 4.0, 1e-3)
NOISE = 1e4


def measured(truth: np.ndarray, noise: float = NOISE) -> Measured:
    values = truth + noise * np.random.default_rng(5).standard_normal(len(truth))
    return Measured("pressure_a", 2, TIME, values, noise)


def lagged(time: np.ndarray, every: float = 0.25, size: float = 4e6, lag: float = 0.014) -> np.ndarray:
    """What a sensor of first order shows of a pressure that jumps up and down: it has a corner at each jump."""
    shown, at_start = np.empty_like(time), 0.0
    for number in range(int(time[-1] / every) + 1):
        inside = (time >= number * every) & (time < (number + 1) * every)
        target = size * (number % 2)
        shown[inside] = target + (at_start - target) * np.exp(-(time[inside] - number * every) / lag)
        at_start = target + (at_start - target) * np.exp(-every / lag)
    return shown


def test_a_corner_is_followed_within_the_noise() -> None:
    truth = lagged(TIME)
    error = np.abs(follow(measured(truth)) - truth)
    assert np.max(error) < 4.0 * NOISE
    assert np.max(np.abs(smooth(measured(truth), 0) - truth)) > 10.0 * NOISE


@pytest.mark.parametrize("truth", [np.zeros_like(TIME), 2e5 * TIME, 3e6 * np.sin(2.0 * np.pi * TIME)])
def test_where_nothing_bends_the_noise_falls_as_through_a_cubic(truth: np.ndarray) -> None:
    """A cubic through n evenly spaced samples has 3 (3 n^2 - 7) / (4 n (n^2 - 4)) of their variance in its middle."""
    n = 19
    variance = 3.0 * (3.0 * n**2 - 7.0) / (4.0 * n * (n**2 - 4.0))
    error = (follow(measured(truth)) - truth) / NOISE
    assert np.mean(error**2) == pytest.approx(variance, rel=0.15)


def test_without_noise_a_channel_is_followed_exactly_where_a_cubic_is() -> None:
    truth = 1e6 * TIME**3 - 2e6 * TIME
    assert follow(measured(truth, 1e-3)) == pytest.approx(truth, abs=1e-2)


def test_a_jump_that_nothing_smooth_follows_is_left_as_measured() -> None:
    truth = np.where(TIME < 2.0, 0.0, 1e8)
    channel = measured(truth)
    beside = np.abs(TIME - 2.0) < 2.5e-3
    assert np.array_equal(follow(channel)[beside], channel.values[beside])
