"""The thresholds that decide what is named: none of them moves unnoticed."""

import numpy as np
import pytest

from eha_core.diagnosis import criteria


def test_no_threshold_moved():
    held = {name: value for name, value in vars(criteria).items() if name.isupper()}
    assert held == {
        "FAR_FROM_NOISE": 5.0,
        "NEAR_NOISE": 1.03,
        "MOST_EFFECTS": 8,
        "CHANCE": 25.0,
        "OF_SAMPLES": 0.001,
        "OF_SAMPLES_BESIDE_A_FORM": 0.004,
        "OF_ITS_FORM": 6e-4,
        "NOISE_KNOWN": 0.02,
        "CONVINCING": 0.63,
        "NEXT_TO_NOTHING": 0.15,
        "WORTH_ADDING": 0.1,
        "LEFT_IN_A_CHANNEL": 1.2,
        "UNFITTED": 1.3,
        "LEAST_OF_A_LAW": 0.5,
        "COHERENT": 1.5,
        "ENOUGH": 20.0,
        "TIE": 10.0,
        "CONTENDING": 20.0,
        "HARDLY": 0.1,
        "OVER": 0.05,
        "ADEQUATE": 1.05,
        "DEAR": 0.03,
        "HELD_OUT": 5.0,
        "PARTLY": 0.2,
        "NEARLY_ALL": 0.1,
        "ITS_FORM": 0.05,
        "WHATEVER_FORM": 0.005,
        "UNKNOWN_MARGIN": 50.0,
        "OUTSTANDING": 1.5,
        "UNTOUCHED": 0.05,
        "LEFT_OVER": 0.05,
        "NOTICEABLE": 4.0,
        "RELEVANT": 0.01,
    }


def test_what_must_be_gained_is_more_than_the_best_of_a_thousand_hypotheses_gains_by_chance():
    generator = np.random.default_rng(1)
    best = np.max(generator.chisquare(1, (2000, 1000)), axis=1)
    assert np.mean(best > criteria.chance_gain(0, 1.0)) < 0.001


def test_what_must_be_gained_rises_with_what_nobody_explains():
    assert criteria.chance_gain(40_000, 3.0) == pytest.approx(3.0 * criteria.chance_gain(40_000, 1.0))
    assert criteria.chance_gain(40_000, 0.5) == criteria.chance_gain(40_000, 1.0)
