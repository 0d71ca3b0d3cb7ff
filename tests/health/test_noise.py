"""Noise and outliers estimated from a channel alone."""

import numpy as np
import pytest

from eha_core.health.noise import estimate_noise, find_outliers, quantisation, residual_noise, usual_size, usual_sizes

TIME = np.arange(20_000) / 1000.0
SMOOTH = 0.02 * np.sin(2 * np.pi * 0.7 * TIME) + 0.003 * np.sin(2 * np.pi * 9.0 * TIME)


@pytest.mark.parametrize("level", [1e-6, 1e-5, 1e-4])
def test_white_noise_on_a_smooth_signal_is_found_within_five_percent(level):
    noisy = SMOOTH + level * np.random.default_rng(3).standard_normal(len(TIME))
    assert estimate_noise(noisy) == pytest.approx(level, rel=0.05)


def test_a_quantised_channel_has_at_least_the_noise_of_its_step():
    step = 5e-5
    values = np.round(SMOOTH / step) * step
    assert quantisation(values) == pytest.approx(step)
    assert estimate_noise(values) >= 0.999 * step / np.sqrt(12.0)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_a_fine_encoder_is_quantised_however_many_of_its_levels_were_seen(kind, unit):
    """25 um over 50 mm of stroke: 2,001 levels in 7,500 samples, one in four."""
    step = 25e-6
    travel = 0.025 * np.sin(2 * np.pi * 0.31 * TIME[:7500]) + 0.025
    values = (np.round(travel / step) * (step / unit)).astype(kind).astype(float) * unit
    assert len(np.unique(values)) == 2001
    assert quantisation(values) == pytest.approx(step, rel=1e-3)
    assert estimate_noise(values) >= 0.999 * step / np.sqrt(12.0)
    values[[77, 3000, 5001]] += 0.37 * step
    assert quantisation(values) == pytest.approx(step, rel=1e-2)


def test_a_few_levels_without_a_common_step_are_no_grid():
    assert quantisation(np.array([0.0, 1.0, 1.0, 4.5, 0.0])) == 0.0


def test_what_is_on_no_grid_is_not_quantised():
    generator = np.random.default_rng(6)
    assert quantisation(SMOOTH) == 0.0
    assert quantisation(SMOOTH + 1e-5 * generator.standard_normal(len(TIME))) == 0.0
    assert quantisation(generator.choice([0.0, 0.3, 0.71, 1.13], 500)) == 0.0
    assert quantisation(np.zeros(100)) == quantisation(np.array([1.0, 2.0] * 50)) == 0.0


def test_a_slow_misfit_does_not_raise_the_noise_of_a_residual():
    residual = np.random.default_rng(4).standard_normal(len(TIME)) + 50.0 * np.sin(TIME)
    assert residual_noise(residual) == pytest.approx(1.0, rel=0.03)


def test_lone_spikes_are_outliers_and_steps_are_not():
    generator = np.random.default_rng(5)
    values = SMOOTH + 1e-5 * generator.standard_normal(len(TIME))
    values[5000:] += 5e-3
    spikes = np.arange(300, 19_000, 1234)
    values[spikes] += 2e-3
    assert np.flatnonzero(find_outliers(values, 1e-5)).tolist() == spikes.tolist()


@pytest.mark.parametrize("step", [0.25, 0.5, 1.0])
def test_noise_on_a_coarse_grid_is_told_to_three_per_cent(step):
    noise = np.random.default_rng(7).standard_normal(20_000)
    coarse = np.round(noise / step) * step
    assert residual_noise(coarse) == pytest.approx(np.sqrt(1.0 + step**2 / 12.0), rel=0.03)


def test_the_usual_size_is_that_of_normal_values_whatever_a_fifth_of_them_is():
    values = 3.0 * np.random.default_rng(8).standard_normal(50_000)
    assert usual_size(values) == pytest.approx(3.0, rel=0.01)
    values[::5] = 1e6
    assert 3.0 < usual_size(values) < 4.2
    assert usual_size(np.zeros(10)) == 0.0


def test_the_step_is_found_where_the_median_lies_between_two_levels() -> None:
    """Of an even number of values the median may be the mean of two levels, off the grid by half a step."""
    levels = np.array([0, 1, 2, 4, 5, 7, 8, 9, 11, 12])
    assert np.median(levels) == 6.0 and np.median(levels[:-2]) == 4.5
    for count in (10, 8):
        assert quantisation(3e-5 * np.repeat(levels[:count], 3)) == pytest.approx(3e-5)


def test_sizes_of_several_pieces_are_those_of_each() -> None:
    generator = np.random.default_rng(5)
    pieces = [generator.standard_normal(count) * size for count, size in ((200, 1.0), (201, 30.0), (150, 0.0))]
    assert usual_sizes(pieces) == pytest.approx([usual_size(piece) for piece in pieces])
    assert usual_sizes(pieces)[:2] == pytest.approx([1.0, 30.0], rel=0.15)
