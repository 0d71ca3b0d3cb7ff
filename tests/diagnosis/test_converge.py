"""A fit that stopped short of its optimum is led there."""

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.converge import converge
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
    free = (*calibration.fitted.free, *free_effect_parameters(ONSET, values))
    stuck = fit(calibration.problem, values, free, calibration.fitted.states)
    assert abs(stuck.values["leakage_onset.time"] - 4.87) > 0.3
    (found,) = converge(calibration.problem, {NOTHING.with_effects([ONSET]): stuck}).values()
    assert found.values["leakage_onset.time"] == pytest.approx(4.87, abs=0.01)
    assert found.data < 1.05 * found.count
