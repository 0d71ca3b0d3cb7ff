"""Searches that begin far from their end get there."""

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.effect_freedom import effect_freedom
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.refine import as_given, settle
from eha_core.effects import effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

ONSET = next(effect for effect in effects() if effect.id == "leakage_onset")
PLANTED = {"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 1e-10}


@pytest.fixture(scope="module")
def calibration():
    return calibrate([observe(recorded(PLANTED, duration=8.0))], NominalModel(nominal_values()), 2e-4)


def test_an_instant_a_second_off_is_found(calibration):
    values = {**calibration.fitted.values, **PLANTED, "leakage_onset.time": 3.6}
    free = (*calibration.fitted.free, *effect_freedom(ONSET, values))
    stuck = fit(calibration.problem, values, free, calibration.fitted.states)
    assert abs(stuck.values["leakage_onset.time"] - 4.87) > 0.3
    (found,) = settle(calibration.problem, {NOTHING.with_effects([ONSET]): stuck}).values()
    assert found.values["leakage_onset.time"] == pytest.approx(4.87, abs=0.01)
    assert found.data < 1.05 * found.count


def test_the_nominal_values_are_given_back_to_a_calibration_that_bent_them(calibration):
    problem, fitted = calibration.problem, calibration.fitted
    bent = [one.name for one in fitted.free if abs(fitted.values[one.name] - one.reference) > 0.02 * one.slope(1.0)]
    assert bent
    given = as_given(problem, fitted)
    assert given.free == fitted.free
    assert given.data > fitted.data
    for one in given.free:
        assert given.values[one.name] == one.reference
        assert one.value(float(given.q[[other.name for other in given.free].index(one.name)])) == one.reference
