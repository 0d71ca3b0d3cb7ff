"""exp(-x) by arithmetic alone."""

from __future__ import annotations

from math import expm1

import numpy as np
import pytest

from eha_core.compiled import compiled
from eha_core.decay import decayed


@compiled
def of_each(values, found):
    for place in range(len(values)):
        found[place] = decayed(values[place])


def decays(values: np.ndarray) -> np.ndarray:
    found = np.empty_like(values)
    of_each(values, found)
    return found


def test_it_is_the_exponential_function_wherever_it_is_asked() -> None:
    values = np.concatenate([[0.0], np.logspace(-12, 2, 20001), np.linspace(0.0, 50.0, 20001)])
    assert np.max(np.abs(decays(values) - np.exp(-values))) < 4e-16
    assert decays(np.zeros(1))[0] == 1.0


def test_what_is_lost_in_a_short_time_is_exact_to_the_last_digits_of_one() -> None:
    values = np.array([1e-3, 1e-5, 1e-7])
    assert 1.0 - decays(values) == pytest.approx([-expm1(-x) for x in values], abs=2.5e-16)


def test_after_a_very_long_time_nothing_is_left_and_it_is_never_below_zero() -> None:
    left = decays(np.array([38.0, 41.0, 700.0, 1e300, np.inf]))
    assert np.all(left >= 0.0)
    assert np.all(left < 4e-16)
