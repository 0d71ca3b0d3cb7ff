"""Noise behind a known filter: its memory is found, and intervals that know of it hold what they promise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from eha_core.identification.colour import WHITE, Colour, colour_of, spread

COUNT = 4000
TIME = np.arange(COUNT) / 500.0


def filtered(kept: float, white: float, generator: np.random.Generator) -> np.ndarray:
    """Noise of first order with unit variance, and white noise of that size after it."""
    start = np.zeros(500)
    driven = np.sqrt(1.0 - kept**2) * generator.standard_normal(COUNT + len(start))
    behind = lfilter([1.0], [1.0, -kept], driven)[len(start) :]
    return behind + white * generator.standard_normal(COUNT)


@pytest.mark.parametrize(("kept", "white"), [(0.5, 0.0), (0.73, 0.0), (0.9, 0.0), (0.9, 0.5), (0.97, 0.3)])
def test_the_memory_of_noise_behind_a_filter_is_found(kept: float, white: float) -> None:
    """exp(-1 / (500 Hz T)): 0.73 behind one of 25 Hz."""
    found = [colour_of(filtered(kept, white, np.random.default_rng([seed, 1]))) for seed in range(10)]
    assert np.mean([colour.kept for colour in found]) == pytest.approx(kept, abs=0.02)
    assert np.mean([colour.share for colour in found]) == pytest.approx(1.0 / (1.0 + white**2), abs=0.03)


def test_white_noise_has_none() -> None:
    assert all(colour_of(np.random.default_rng([seed, 2]).standard_normal(COUNT)) == WHITE for seed in range(200))
    assert colour_of(np.zeros(100)) == colour_of(np.ones(5)) == WHITE


def test_the_spread_of_a_sum_is_that_over_all_pairs() -> None:
    pulls = np.random.default_rng(3).standard_normal((60, 2))
    colour = Colour(0.8, 0.7)
    lags = np.abs(np.subtract.outer(np.arange(60), np.arange(60)))
    pairs = np.where(lags == 0, 1.0, colour.share * colour.kept**lags)
    assert spread(pulls, colour) == pytest.approx(np.diag(pulls.T @ pairs @ pulls))
    assert spread(pulls, WHITE) == pytest.approx(np.sum(pulls**2, axis=0))


def test_a_filter_leaves_slow_noise_as_it_is() -> None:
    """So what a filter of gain one leaves of white noise is as loud at low frequencies as it was before."""
    for kept in (0.5, 0.73, 0.9):
        behind = [np.sqrt((1.0 - kept) / (1.0 + kept)) * filtered(kept, 0.0, np.random.default_rng([seed, 4]))
                  for seed in range(10)]  # fmt: skip
        before = [np.std(noise) * np.sqrt(colour_of(noise).slow) for noise in behind]
        assert np.mean(before) == pytest.approx(1.0, rel=0.05)


COLUMNS = np.stack([np.ones(COUNT), np.sin(2.0 * np.pi * 0.8 * TIME), np.cos(2.0 * np.pi * 6.0 * TIME)], axis=1)
FILTERS = {
    "white": ([1.0], [1.0]),
    "first order, 25 Hz": ([1.0], [1.0, -np.exp(-2.0 * np.pi * 25.0 / 500.0)]),
    "first order, 1 Hz": ([1.0], [1.0, -np.exp(-2.0 * np.pi * 1.0 / 500.0)]),
    "Butterworth of second order, 25 Hz": butter(2, 25.0, fs=500.0),
}


@pytest.mark.parametrize("name", FILTERS)
def test_a_95_per_cent_interval_holds_the_true_value_so_often(name: str) -> None:
    """Of 300 fits of a linear model under the noise behind each filter, with the residual alone known of it."""
    solved = np.linalg.pinv(COLUMNS).T
    generator = np.random.default_rng(5)
    inside, narrow = [], []
    for _ in range(300):
        noise = lfilter(*FILTERS[name], generator.standard_normal(COUNT + 1000))[1000:]
        found = noise @ solved  # the true values are zero
        residual = noise - COLUMNS @ found
        variance = np.mean(residual**2) * spread(solved, colour_of(residual))
        inside.append(np.abs(found) < 1.96 * np.sqrt(variance))
        narrow.append(np.abs(found) < 1.96 * np.sqrt(np.mean(residual**2) * np.sum(solved**2, axis=0)))
    assert np.mean(inside) == pytest.approx(0.95, abs=0.035)
    if name != "white":
        assert np.mean(narrow) < 0.75
