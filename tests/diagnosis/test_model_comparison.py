"""Where all that was tried stays far off, every start is tried from the nominal values."""

from dataclasses import replace

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.facts import gather
from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.model_comparison import Entry, ModelComparison, from_every_start
from eha_core.diagnosis.refine import FAR_OFF
from eha_core.diagnosis.screen import screen
from eha_core.effects import effects
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
ABLE = (LAWS["constant_load"], LAWS["leakage_onset"])
PLANTED = {"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 3e-10}


@pytest.fixture(scope="module")
def calibration():
    return calibrate([observe(recorded(PLANTED, duration=8.0))], NominalModel(nominal_values()), 2e-4)


@pytest.fixture(scope="module")
def score_tests(calibration):
    facts = gather([observe(recorded(PLANTED, duration=8.0))], calibration.shooting, calibration.fitted)
    initial_guesses = [start for effect in ABLE for start in starts(effect, facts)]
    return screen(calibration.problem, calibration.fitted, initial_guesses)


def test_the_effect_that_was_passed_over_is_found(calibration, score_tests):
    assert calibration.fitted.data > FAR_OFF * calibration.fitted.count
    nothing_tried = ModelComparison(Entry(NOTHING, calibration.fitted, 0.0), (), score_tests, 1.0)
    found = from_every_start(calibration.problem, nothing_tried)
    winner = found.entries[0]
    assert winner.ids == ("leakage_onset",)
    assert winner.fit.data < 1.05 * winner.fit.count
    assert winner.fit.values["leakage_onset.time"] == pytest.approx(4.87, abs=0.01)


def test_what_leaves_little_is_left_alone(calibration, score_tests):
    near = replace(calibration.fitted, data=0.9 * FAR_OFF * calibration.fitted.count)
    comparison = ModelComparison(Entry(NOTHING, near, 0.0), (), score_tests, 1.0)
    assert from_every_start(calibration.problem, comparison) is comparison
