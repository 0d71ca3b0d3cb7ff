"""What is claimed is what the recording bears: real fits to recordings whose answer is known."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest
from made import LAWS, recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.fitted_values import named_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.sets.comparison import Entry, ModelComparison
from eha_core.diagnosis.supported import one_sided, supported
from eha_core.diagnosis.verdict import Decision
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.identification.problem import whole
from eha_core.identification.together import cut_together
from eha_core.identification.validate import Judged
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER
from eha_core.quantities import quantity


@pytest.fixture(scope="module")
def sound():
    """The evidence of a rig that lacks nothing."""
    observation = observe(recorded({}, duration=4.0))
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    return SimpleNamespace(
        observation=observation,
        observations=(observation,),
        nominal=nominal_values(),
        calibration=calibration,
        comparison=ModelComparison(Entry(NOTHING, calibration.fitted, 0.0), (), 1.0),
    )


def entry(evidence, start):
    """A set of effects fitted from these values."""
    chosen = [LAWS[name] for name in sorted({name.partition(".")[0] for name in start})]
    calibrated = evidence.calibration.fitted
    begun = {**calibrated.values, **start}
    free = with_effects(calibrated.free, chosen, begun)
    found = fit(evidence.calibration.problem, begun, free, calibrated.states, iterations=10)
    return Entry(NOTHING.with_effects(chosen), found, 30.0)


def test_an_effect_whose_interval_holds_nothing_is_not_named(sound):
    winner = entry(sound, {"constant_load.force": 3.0})
    found = supported(sound, Decision("missing_physics", winner, (), None, None))
    assert (found.verdict, found.winner.ids) == ("consistent", ())


def test_what_predicts_worse_than_the_nominal_model_is_never_given(sound):
    winner = Entry(NOTHING, sound.calibration.fitted, 0.0)
    bad = Judged(1e6, 1000, {}, {})
    found = supported(sound, Decision("parameters", winner, (), None, bad))
    assert found.as_given and found.winner.fit is sound.calibration.nominal
    assert found.verdict == "consistent"
    assert found.judged_winner is found.judged_nominal and found.judged_winner.chi_square < 1e5
    fine = Decision("parameters", winner, (), None, replace(found.judged_winner))
    assert supported(sound, fine) is fine


def test_where_the_nominal_model_is_far_off_too_something_is_missing_that_has_no_name(sound):
    off = replace(sound.calibration.nominal, residuals=tuple(9.0 * one for one in sound.calibration.nominal.residuals))
    evidence = SimpleNamespace(**{**vars(sound), "calibration": replace(sound.calibration, nominal=off)})
    found = supported(evidence, Decision("parameters", Entry(NOTHING, off, 0.0), (), None, Judged(1e6, 1000, {}, {})))
    assert (found.verdict, found.as_given) == ("unknown_physics", True)


@pytest.fixture(scope="module")
def stuck():
    """A piston that 40 kN of friction hold; what the oil pushes with is some kilonewtons."""
    given = nominal_values() | {"coulomb_friction.force": 3e4}
    observation = observe(recorded({"coulomb_friction.force": 4e4}, duration=2.0))
    problem = whole(cut_together([observation], given, 2e-4))
    free = with_effects((), [LAWS["coulomb_friction"]], given)
    found = fit(problem, given, free, iterations=6)
    return SimpleNamespace(observation=observation, calibration=SimpleNamespace(problem=problem)), found


def test_friction_that_holds_a_piston_is_so_much_at_least(stuck):
    evidence, found = stuck
    winner = Entry(NOTHING.with_effects([LAWS["coulomb_friction"]]), found, 1e4)
    unsure = replace(found, covariance=1e4 * abs(found.covariance))  # as where the search came from elsewhere
    ends = one_sided(evidence, unsure, winner)
    low, high = ends["coulomb_friction.force"]
    pushed = max(evidence.observation.channel(f"pressure_{one}").values.max() for one in "ab") * 645e-6
    assert high is None
    assert 500.0 < low < pushed
    (named,) = named_effects(winner, unsure, PAPER, (), ends)
    assert named.parameters["force"].interval == (low, None)
    assert f"at least {quantity(low, 'N')} of dry friction" in named.statement
