"""Coordinates of the parameters that a fit moves."""

import numpy as np
import pytest

from eha_core.identification.fit import Ending, Fit
from eha_core.identification.free_parameters import FreeParameter, coordinates, values_at

SLIDING = FreeParameter("sliding", 100.0, False, 100.0, 30.0, 0.0, 1e5)
STATIC = FreeParameter("static", 0.0, False, 1.0, 30.0, 0.0, 3.0, above="sliding")
MASS = FreeParameter("mass", 9.0, True, 0.0, 0.7, 2.0, 40.0)
FREE = (STATIC, SLIDING, MASS)


def test_values_come_back_from_their_coordinates():
    values = {"static": 230.0, "sliding": 170.0, "mass": 11.0, "held": 1.0}
    assert values_at(values, FREE, coordinates(FREE, values)) == pytest.approx(values)


def test_what_is_above_another_goes_along_with_it_and_never_below():
    values = {"static": 230.0, "sliding": 170.0, "mass": 11.0}
    q = coordinates(FREE, values)
    raised = values_at(values, FREE, q + [0.0, 0.5, 0.0])
    assert (raised["sliding"], raised["static"]) == pytest.approx((220.0, 220.0 * 230.0 / 170.0))
    below = values_at(values, FREE, coordinates(FREE, {**values, "static": 90.0}))
    assert below["static"] == below["sliding"] == pytest.approx(170.0)
    lowest = values_at(values, FREE, q - [1e3, 0.0, 0.0])
    assert lowest["static"] == pytest.approx(170.0)
    highest = values_at(values, FREE, q + [1e3, 0.0, 0.0])
    assert highest["static"] == pytest.approx(4.0 * 170.0)


def test_what_begins_past_its_share_begins_at_the_bound():
    """From past it, neither a step up nor one down would change anything."""
    values = {"static": 600.0, "sliding": 100.0, "mass": 11.0}
    q = coordinates(FREE, values)
    assert values_at(values, FREE, q)["static"] == pytest.approx(400.0)
    assert values_at(values, FREE, q - [0.1, 0.0, 0.0])["static"] == pytest.approx(390.0)


def test_deviations_are_those_of_the_values():
    """Against draws of the coordinates."""
    generator = np.random.default_rng(4)
    root = 0.01 * generator.normal(size=(3, 3))
    values = {"static": 230.0, "sliding": 170.0, "mass": 11.0}
    q = coordinates(FREE, values)
    found = Fit(
        FREE, q, values, np.zeros((1, 4)), 0.0, 0.0, 1, (), root @ root.T, Ending.CONVERGED, 1
    )  # fmt: skip
    drawn = [values_at(values, FREE, q + root @ generator.normal(size=3)) for _ in range(20000)]
    names = [one.name for one in FREE]
    expected = np.cov([[one[name] for one in drawn] for name in names])
    assert found.covariance_of(names) == pytest.approx(expected, rel=0.05, abs=0.05 * np.min(np.diag(expected)))
    assert found.deviation("static") == pytest.approx(np.sqrt(expected[0, 0]), rel=0.02)
