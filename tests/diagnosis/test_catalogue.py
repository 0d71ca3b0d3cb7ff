"""Every effect of the catalogue, planted in the plant and found again behind wrong parameters."""

import pytest
from planted import NOT_IDENTIFIABLE, planted, require_measured

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.criteria import ENOUGH
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.converge import converge
from eha_core.diagnosis.search.initial_guesses import applicable_effects, initial_guesses
from eha_core.diagnosis.search.model_comparison import REFINED
from eha_core.diagnosis.search.planned_refits import planned_refits, refit_with
from eha_core.diagnosis.search.screening import screen
from eha_core.effects import effects
from eha_core.nominal import NominalModel

NAMED = [effect for effect in effects() if effect.named]


@pytest.mark.parametrize("effect", [one for one in NAMED if one.id not in NOT_IDENTIFIABLE], ids=lambda one: one.id)
def test_what_is_planted_is_screened_in_and_measured(effect):
    values, nominal, observation = planted(effect)
    calibration = calibrate([observation], NominalModel(nominal), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    tried = [guess for one in applicable_effects([observation]) for guess in initial_guesses(one, scales)]
    score_tests = screen(calibration.problem, calibration.fitted, tried)
    leading = planned_refits(calibration.problem, calibration.fitted, tried, score_tests, REFINED, ENOUGH)
    planned = next((one for one in leading if one.score_test.guess.effect.id == effect.id), None)
    assert planned is not None, [one.score_test.guess.effect.id for one in leading]
    first = refit_with(calibration.problem, planned, float("inf"))
    (result,) = converge(calibration.problem, {NOTHING.with_effects([effect]): first}).values()
    assert result.data / result.count < 1.1
    assert calibration.fitted.objective - result.objective > 50.0
    require_measured(effect, values, result)
