"""What each effect of a set is worth: what the nominal, the recalibrated and the augmented model leave, and without
each."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.conclude import polish
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING, without_effect
from eha_core.diagnosis.ladder import correlation, ladder
from eha_core.diagnosis.search.comparison import Entry, ModelComparison
from eha_core.effects import effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
PLANTED = {"constant_load.force": 60.0, "valve_deadband.half_width": 2e-4}


@pytest.fixture(scope="module")
def evidence():
    """A rig with a small load and a large overlap, with the fit of both."""
    observation = observe(recorded(PLANTED, duration=4.0))
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    chosen = [LAWS[name.partition(".")[0]] for name in PLANTED]
    begun = {**nominal_values(), **PLANTED}
    free = with_effects(calibration.fitted.free, chosen, begun)
    found = fit(calibration.problem, begun, free, iterations=15)
    return SimpleNamespace(
        observations=(observation,),
        nominal=nominal_values(),
        calibration=calibration,
        comparison=ModelComparison(Entry(NOTHING, calibration.fitted, 0.0), (), 1.0),
        decision=SimpleNamespace(winner=Entry(NOTHING.with_effects(chosen), found, 100.0)),
    )


def test_the_way_leads_from_the_nominal_model_to_the_noise_and_the_effect_that_matters_most_comes_first(evidence):
    final = polish(evidence, evidence.decision.winner)
    steps, without = ladder(evidence, final)
    assert [one.added for one in steps] == ["nominal", "recalibrated", "augmented"]
    overall = [one.residual.overall for one in steps]
    assert overall == sorted(overall, reverse=True)
    assert overall[-1] == pytest.approx(1.0, abs=0.05)
    assert steps[-1].residual.times_noise == {
        name: pytest.approx(float(np.sqrt(np.mean(one**2))))
        for name, one in zip(evidence.calibration.shooting.names, final.residuals, strict=True)
    }
    assert list(without) == ["valve_deadband", "constant_load"]
    assert overall[1] > without["valve_deadband"].overall > without["constant_load"].overall > 2.0 * overall[-1]
    # by hand: the set less the overlap, fitted from the nominal values
    load = with_effects(evidence.calibration.fitted.free, [LAWS["constant_load"]], {"constant_load.force": 60.0})
    begun = {**nominal_values(), "constant_load.force": 60.0}
    by_hand = fit(evidence.calibration.problem, begun, load, iterations=40)
    left = np.sqrt(by_hand.data / by_hand.count)
    assert without["valve_deadband"].overall == pytest.approx(left, rel=0.1)


def test_a_fit_that_the_search_gave_up_is_not_what_is_shown(evidence):
    winner, problem = evidence.decision.winner, evidence.calibration.problem
    begun, load = without_effect(winner.fit, LAWS["valve_deadband"])
    given_up = fit(problem, begun, load, winner.fit.states, iterations=1)
    (deadband,) = (member for member in winner.hypothesis.members if member.id == "valve_deadband")
    smaller = {winner.hypothesis.without(deadband): given_up}
    searched = {**vars(evidence), "comparison": replace(evidence.comparison, smaller=smaller)}
    final = polish(evidence, winner)
    (_, expected), (_, shown) = ladder(evidence, final), ladder(SimpleNamespace(**searched), final)
    left = np.sqrt(given_up.data / given_up.count)
    assert left > 1.2 * expected["valve_deadband"].overall
    assert shown["valve_deadband"].overall == pytest.approx(expected["valve_deadband"].overall, rel=0.02)


def test_parameters_that_a_recording_tells_only_together_are_correlated(evidence):
    found = correlation(evidence.decision.winner.fit)
    matrix = np.array(found.matrix)
    assert found.names == tuple(one.name for one in evidence.decision.winner.fit.free)
    assert np.allclose(matrix, matrix.T)
    assert np.allclose(np.diag(matrix), 1.0)
    assert np.abs(matrix).max() <= 1.0
    assert np.linalg.eigvalsh(matrix).min() > -1e-6
    # the flow is the gain times the root of the pressure drop: more supply pressure compensates for less gain
    gain, supply = found.names.index("valve_gain"), found.names.index("supply_pressure")
    assert matrix[gain, supply] < -0.5


def test_without_effects_the_way_ends_at_the_recalibrated_model(evidence):
    alone = SimpleNamespace(**{**vars(evidence), "decision": SimpleNamespace(winner=evidence.comparison.nominal)})
    steps, without = ladder(alone, evidence.calibration.fitted)
    assert [one.added for one in steps] == ["nominal", "recalibrated"]
    assert without == {}
