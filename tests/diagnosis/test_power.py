"""The power against drawn noise, and the required gain against the two rules that it is made of."""

from __future__ import annotations

from math import log

import numpy as np
import pytest

from eha_core.diagnosis.criteria import CERTAINTY, ENOUGH
from eha_core.diagnosis.detection.power import energy_needed, probability_of, required_gain


@pytest.mark.parametrize("parameters", [1, 2, 5])
def test_the_energy_is_found_as_often_as_it_says(parameters: int) -> None:
    """A fit of so many parameters gains the squared length of noise and response within as many directions."""
    gain = 40.0
    energy = energy_needed(gain, parameters)
    noise = np.random.default_rng(parameters).normal(size=(100_000, parameters))
    noise[:, 0] += np.sqrt(energy)
    found = np.mean(np.sum(noise**2, axis=1) > gain)
    assert found == pytest.approx(CERTAINTY, abs=0.003)
    assert probability_of(energy, gain, parameters) == pytest.approx(CERTAINTY, abs=1e-9)


def test_half_the_size_is_found_seldom() -> None:
    energy = energy_needed(40.0, 1)
    assert probability_of(0.25 * energy, 40.0, 1) < 0.1 < 0.9 < probability_of(1.5 * energy, 40.0, 1)


def test_the_gain_that_is_required_is_the_stricter_of_two_rules() -> None:
    assert required_gain(45.0, 1, 20_000) == 45.0
    assert required_gain(26.0, 3, 1_000) == ENOUGH + 3 * log(1_000)
    assert required_gain(26.0, 3, 1_000, variance=1.04) == 1.04 * (ENOUGH + 3 * log(1_000))
