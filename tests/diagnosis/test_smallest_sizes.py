"""The smallest sizes: the search for them on known functions, and on the rig against the energy that was asked for."""

from __future__ import annotations

from math import exp, inf, log

import numpy as np
import pytest
from tested_rig import at

from eha_core.detectability.planned import RigAsModelled
from eha_core.diagnosis.detection.responses import responses
from eha_core.diagnosis.detection.rows import middle_shapes
from eha_core.diagnosis.detection.sizes import CLOSE, _reached, next_guess, smallest, trials


def found(energy, wanted: float, highest: float, passes: int = 10) -> float:
    """Where guesses end for an energy as a function of the logarithm of the factor."""
    seen: list[tuple[float, float]] = []
    for _ in range(passes):
        guess = next_guess(seen, wanted, highest)
        seen.append((guess, energy(guess)))
        if abs(seen[-1][1] - wanted) < CLOSE:
            break
    return seen[-1][0]


def test_a_linear_effect_is_met_at_the_second_guess() -> None:
    assert found(lambda x: 2.0 * x + 10.0, log(66.0), 20.0, passes=2) == pytest.approx(0.5 * (log(66.0) - 10.0))


def test_a_dead_band_that_little_motion_does_not_reach_is_met() -> None:
    """Nothing up to a factor of 5, and the square of what is beyond: 5 + sqrt(66)."""

    def energy(x: float) -> float:
        beyond = np.exp(x) - 5.0
        return 2.0 * log(beyond) if beyond > 0.0 else -inf

    assert np.exp(found(energy, log(66.0), log(1e3), passes=20)) == pytest.approx(5.0 + 66.0**0.5, rel=0.05)


def test_an_effect_that_grows_and_levels_off_is_met_where_it_is_small() -> None:
    assert np.exp(found(lambda x: log(1e4 * np.tanh(np.exp(x)) ** 2), log(66.0), log(100.0))) == pytest.approx(
        np.arctanh(66.0**0.5 / 100.0), rel=0.03
    )


def test_what_never_shows_ends_at_the_highest_size() -> None:
    assert found(lambda _: -inf, log(66.0), log(50.0)) == pytest.approx(log(50.0))


def test_a_response_that_is_not_of_its_size_states_nothing(rig: RigAsModelled) -> None:
    trial = trials(rig)[0]
    energy = log(trial.energy)
    assert _reached([(0.0, energy + 9.0), (-7.0, energy + 9.0), (-14.0, energy + 9.0)], trial) == 0.0
    assert _reached([(0.0, energy + 9.0), (-7.0, energy - 1.0), (-5.0, energy)], trial) == pytest.approx(exp(-5.0))
    assert middle_shapes([trial], [0.0]) == ([], [])


@pytest.fixture(scope="module")
def rig() -> RigAsModelled:
    return at()


def test_every_size_has_the_energy_that_is_asked_for(rig: RigAsModelled) -> None:
    tried = trials(rig)
    factors = smallest(rig, tried)
    known = [k for k, factor in enumerate(factors) if np.isfinite(factor)]
    assert {trial.column.effect.id for trial in tried} - {tried[k].column.effect.id for k in known} == {
        "position_sensor_scale"
    }
    seen = responses(rig, [tried[k].at(float(factors[k])) for k in known])
    for place, k in enumerate(known):
        below = seen.left(place) / tried[k].energy
        # a large size may do less than a smaller one, so that a bracket of two is the answer
        assert 0.95 < below < 4.0, tried[k].column.effect.id
    shares = [seen.left(place) / tried[k].energy for place, k in enumerate(known)]
    assert np.median(shares) == pytest.approx(1.0, abs=0.04)


def test_more_noise_asks_for_as_much_more_of_a_linear_effect(rig: RigAsModelled) -> None:
    """Three times the noise: three times the load that is found, but for what priors then hold of the parameters."""
    sizes = []
    for each in (rig, at(noise=3.0)):
        tried = [trial for trial in trials(each) if trial.column.effect.id == "constant_load"]
        pairs = zip(tried, smallest(each, tried), strict=True)
        sizes.append(max(factor * abs(trial.column.values["constant_load.force"]) for trial, factor in pairs))
    assert sizes[1] == pytest.approx(3.0 * sizes[0], rel=0.1)


def test_of_two_signs_the_weaker_and_of_three_shapes_the_middle_one_is_certified(rig: RigAsModelled) -> None:
    tried = [trial for trial in trials(rig) if trial.column.effect.id in ("constant_load", "bore_wear_leakage")]
    factors = [float(k + 1) for k in range(len(tried))]
    chosen, chosen_factors = middle_shapes(tried, factors)
    by_effect = dict(zip((trial.column.effect.id for trial in chosen), chosen_factors, strict=True))
    loads = [f for t, f in zip(tried, factors, strict=True) if t.column.effect.id == "constant_load"]
    wears = sorted(f for t, f in zip(tried, factors, strict=True) if t.column.effect.id == "bore_wear_leakage")
    assert len(loads) == 2 and by_effect["constant_load"] == max(loads)
    assert len(wears) == 3 and by_effect["bore_wear_leakage"] == wears[1]
