"""Channels are followed as closely as their noise allows: windows start there, and sensors that lag with them."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.identification.observation import Measured
from eha_core.identification.segments import BENT, follow, smooth

TIME = np.arange(0.0, 4.0, 1e-3)
NOISE = 1e4


def measured(truth: np.ndarray, noise: float = NOISE, seed: int = 5) -> Measured:
    values = truth + noise * np.random.default_rng(seed).standard_normal(len(truth))
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
    channel = measured(truth)
    near = np.abs((TIME + 0.125) % 0.25 - 0.125) < 5e-3
    followed, smoothed = (np.sqrt(np.mean((one - truth)[near] ** 2)) for one in (follow(channel), smooth(channel, 0)))
    assert followed < 1.5 * NOISE
    assert smoothed > 5.0 * NOISE
    assert np.max(np.abs(follow(channel) - channel.values)) < BENT * NOISE


def test_noise_alone_makes_no_sample_stand_for_the_channel() -> None:
    """Where a sensor has play, a window would keep the error of the sample that it begins with."""
    for seed in range(5):
        channel = measured(np.zeros_like(TIME), seed=seed)
        assert np.mean(follow(channel) == channel.values) < 1e-3


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
    beside = (TIME > 2.0 - 2.5e-3) & (TIME < 2.0 + 1.5e-3)  # where five samples lie on both sides
    assert np.array_equal(follow(channel)[beside], channel.values[beside])


@pytest.mark.parametrize("lost", [0.05, 0.5])
def test_no_cubic_goes_through_samples_on_both_sides_of_a_gap(lost: float) -> None:
    """A piston at 0.1 m/s, of whose position a part is lost: at the gap's sides the speed is what it is everywhere."""
    kept = np.abs(TIME - 1.0 - 0.5 * lost) > 0.5 * lost
    noise = 1e-5
    values = 0.1 * TIME[kept] + noise * np.random.default_rng(5).standard_normal(np.sum(kept))
    channel = Measured("position", 0, TIME[kept], values, noise)
    beside = np.abs(channel.time - 1.0 - 0.5 * lost) < 0.5 * lost + 0.01
    assert smooth(channel, 1)[beside] == pytest.approx(0.1, abs=0.03)
    assert follow(channel)[beside] == pytest.approx(0.1 * channel.time[beside], abs=5.0 * noise)


def test_a_piece_between_gaps_may_be_a_single_sample() -> None:
    kept = (np.abs(TIME - 1.0) > 0.2) | (TIME == 1.0)
    channel = Measured("position", 0, TIME[kept], 0.1 * TIME[kept], 1e-6)
    alone = channel.time == 1.0
    assert follow(channel)[alone] == 0.1 and smooth(channel, 1)[alone] == 0.0
