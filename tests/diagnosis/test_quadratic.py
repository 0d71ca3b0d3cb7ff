"""The quadratic model of chi^2, against real fits where what is missing is small."""

import numpy as np
import pytest
from made import LAWS, bench

from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.best_sets import objective_without
from eha_core.diagnosis.search.quadratic import quadratic_model
from eha_core.identification.fit import exact, fit
from eha_core.identification.problem import objective_of

PLANTED = {
    "constant_load.force": 10.0,
    "turbulent_leakage.coefficient": 2e-9,
    "valve_null_offset.offset": 2e-6,
}
INNER = {"return_pressure": 5e5, "spring_stiffness": 3e3, "internal_leakage": 2e-12}
"""Nominal values away from zero, where bounds make the plant less than linear."""
SETS = [
    ("constant_load",),
    ("turbulent_leakage",),
    ("constant_load", "turbulent_leakage"),
    ("constant_load", "directional_damping"),
    ("constant_load", "turbulent_leakage", "valve_null_offset"),
]


@pytest.fixture(scope="module")
def rig():
    return bench(PLANTED, INNER, duration=4.0)


@pytest.fixture(scope="module")
def model(rig):
    """About the nominal equations."""
    return quadratic_model(exact(rig.pool.problem), rig.pool.found[NOTHING], NOTHING, rig.pool.plant, rig.columns)


def predicted(model, chosen):
    """The objective that the model predicts of a set."""
    return model.empty - model.gain(chosen)[0]


def best_of(model, names):
    """The guesses of these effects that are predicted to gain most together."""
    chosen = []
    for name in names:
        offered = [option for option in model.options if option.member.id == name and not option.present]
        chosen.append(min(offered, key=lambda option: predicted(model, [*chosen, option])))
    return tuple(chosen)


def at_start(rig, model, chosen, share):
    """The objective where a fit would begin."""
    values, states = model.start(chosen, share)
    rows, ends = rig.pool.problem.shooting.simulate(values, states)
    return objective_of(rig.pool.problem, (), np.zeros(0), states, rows, ends)


@pytest.mark.parametrize("names", SETS, ids="+".join)
def test_what_is_predicted_of_a_set_is_what_a_fit_reaches(rig, model, names):
    nominal = rig.pool.found[NOTHING].objective
    chosen = best_of(model, names)
    values, states = model.start(chosen)
    hypothesis = NOTHING.with_effects([LAWS[name] for name in names])
    problem = exact(rig.pool.problem)
    result = fit(problem, values, rig.pool.free(hypothesis, values), states, iterations=20, in_a_row=2)
    gained = nominal - result.objective
    assert gained > 100.0
    assert nominal - predicted(model, chosen) == pytest.approx(gained, rel=0.04)


def test_of_no_set_the_nominal_fit_is_predicted(rig, model):
    assert predicted(model, ()) == pytest.approx(rig.pool.found[NOTHING].objective, rel=5e-3)


def test_a_fit_begins_near_its_optimum_and_on_the_way_as_a_parabola_has_it(rig, model):
    chosen = best_of(model, ("constant_load",))
    nominal = rig.pool.found[NOTHING].objective
    result = rig.fitted({"constant_load.force": PLANTED["constant_load.force"]})
    gain = nominal - result.objective
    for share, part in ((1.0, 1.0), (0.5, 0.75), (0.25, 0.4375)):
        assert nominal - at_start(rig, model, chosen, share) == pytest.approx(part * gain, abs=0.05 * gain)
    values, states = model.start(chosen)
    for name in ("constant_load.force", "moving_mass", "valve_gain", "damping_coefficient", "supply_pressure"):
        assert values[name] == pytest.approx(result.values[name], rel=0.02)
    assert np.abs(states - result.states)[:, 0].max() < 0.5 * rig.observation.channel("position").noise


def test_what_dropping_a_member_costs_is_what_a_refit_without_it_finds(rig):
    whole = {name: value for name, value in PLANTED.items() if "." in name}
    at = rig.fitted(whole)
    hypothesis = rig.set_of(*{name.partition(".")[0] for name in whole})
    about = quadratic_model(exact(rig.pool.problem), at, hypothesis, rig.pool.plant, ())
    assert all(option.present for option in about.options)
    assert objective_without(about, ()) == pytest.approx(at.objective, rel=5e-3)
    for member in hypothesis.members:
        rest = {name: value for name, value in whole.items() if not name.startswith(member.id)}
        refitted = rig.fitted(rest, 20).objective - at.objective
        assert refitted > 100.0
        assert objective_without(about, [member]) - at.objective == pytest.approx(refitted, rel=0.1)


def test_a_set_is_predicted_as_it_is_however_much_its_members_explain():
    """Else a small effect beside a large one would not be seen to gain anything."""
    large = {"constant_load.force": 3000.0}
    rig = bench(large, duration=4.0)
    at, hypothesis = rig.fitted(large, 20), rig.set_of("constant_load")
    about = quadratic_model(exact(rig.pool.problem), at, hypothesis, rig.pool.plant, ())
    assert objective_without(about, hypothesis.members) > 1e4 * at.count
    assert predicted(about, about.options) == pytest.approx(at.objective, abs=2.0)


def test_members_that_are_not_in_a_set_are_put_out_and_stay_out(rig):
    at = rig.fitted({"constant_load.force": 10.0, "valve_null_offset.offset": 2e-6})
    hypothesis = rig.set_of("constant_load", "valve_null_offset")
    columns = rig.columns_of("turbulent_leakage")
    about = quadratic_model(exact(rig.pool.problem), at, hypothesis, rig.pool.plant, columns)
    kept = next(option for option in about.options if option.member.id == "constant_load")
    added = next(option for option in about.options if option.member.id == "turbulent_leakage")
    values, _ = about.start((kept, added))
    assert values["valve_null_offset.offset"] == 0.0
    assert values["constant_load.force"] != 0.0 and values["turbulent_leakage.coefficient"] > 0.0


def test_a_guess_that_changes_nothing_is_no_option(model):
    """An end stop beyond both ends of the motion; one within is offered."""
    stops = [option.columns[0].values for option in model.options if option.member.id == "end_stop"]
    assert stops
    assert all(min(values["end_stop.upper"], -values["end_stop.lower"]) < 0.5 for values in stops)


def test_no_parameter_is_predicted_beyond_its_bounds(rig, model):
    """A return pressure at nothing cannot go lower, whatever it would gain there."""
    rows = {parameter.name: parameter for parameter in model.at.free}
    at_bounds = 0
    for option in model.options:
        values, _ = model.start((option,))
        for name, parameter in rows.items():
            assert parameter.lower <= values[name] <= parameter.upper
        _, moves = model.gain((option,))
        for place, parameter in enumerate(model.at.free):
            reached = model.at.q[place] + moves[place]
            assert parameter.coordinate(parameter.lower) - 1e-6 <= reached if np.isfinite(parameter.lower) else True
            at_bounds += parameter.lower == values[parameter.name]
    assert at_bounds > 0
