"""The minimum within bounds, against a solver of SciPy's."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from eha_core.diagnosis.search.box import within_bounds


def problem(seed, size, alike):
    """A curvature whose columns are alike to some degree, a slope, and bounds of which some are met."""
    generator = np.random.default_rng(seed)
    factor = generator.standard_normal((2 * size, size)) + alike * generator.standard_normal((2 * size, 1))
    factor /= np.linalg.norm(factor, axis=0)
    target = 10.0 * generator.standard_normal(2 * size)
    lower = -np.abs(generator.standard_normal(size)) * generator.integers(0, 2, size)
    upper = np.where(generator.integers(0, 2, size) == 1, np.inf, generator.uniform(0.1, 3.0, size))
    return factor, target, lower, upper


def solved(factor, target, lower, upper, places):
    found = np.empty(len(places))
    gain = within_bounds(factor.T @ factor, factor.T @ target, lower, upper, places, len(places), found)
    return gain, found


@pytest.mark.parametrize("alike", [0.0, 1.0, 5.0])
def test_it_is_the_minimum_of_bounded_least_squares(alike):
    met = 0
    for seed in range(40):
        factor, target, lower, upper = problem(seed, 12, alike)
        places = np.random.default_rng(seed).permutation(12)[: 4 + seed % 9]
        gain, found = solved(factor, target, lower, upper, places)
        expected = lsq_linear(factor[:, places], target, (lower[places], upper[places]), tol=1e-14)
        assert gain == pytest.approx(target @ target - 2.0 * expected.cost, rel=1e-6, abs=1e-6)
        np.testing.assert_allclose(found, expected.x, atol=1e-4)
        met += np.sum((found == lower[places]) | (found == upper[places]))
    assert met > 40


def test_two_columns_that_are_one_have_no_minimum_of_their_own():
    factor, target, lower, upper = problem(1, 4, 0.0)
    factor[:, 3] = factor[:, 2]
    lower[:], upper[:] = -1e9, 1e9
    assert solved(factor, target, lower, upper, np.arange(4))[0] == -1.0
    assert solved(factor, target, lower, upper, np.arange(3))[0] > 0.0
