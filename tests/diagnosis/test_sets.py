"""Sets of effects: found together, without what is not significant, with the residual stated."""

from dataclasses import replace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis import criteria, diagnose
from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.found import MOST_FITS, Effort
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.diagnosis.search.prune import asked_of, by_chance, prune, refit_without, wald
from eha_core.diagnosis.verdict import coherence
from eha_core.effects import effects
from eha_core.exam.drawing import draw_case
from eha_core.exam.measuring import measure, simulate_case
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.recording import Channel, Recording

LAWS = {effect.id: effect for effect in effects()}
PLANTED = {"constant_load.force": 300.0, "valve_deadband.half_width": 1e-4}


@pytest.fixture(scope="module")
def search():
    """A search on a rig with a load and an overlap, the fit of both and of a third that is not there."""
    observation = observe(recorded(PLANTED, duration=6.0))
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    made = Search(calibration.problem, applicable_effects([observation]), scales)
    made.keep(NOTHING, calibration.fitted)
    return made


def fitted(search, names, values):
    chosen = [LAWS[name] for name in names]
    begun = {**nominal_values(), **values}
    free = with_effects(search.found[NOTHING].free, chosen, begun)
    return search.try_proposal(Proposal(NOTHING.with_effects(chosen), begun, free, None), 15)


@pytest.fixture(scope="module")
def three(search):
    names = ("constant_load", "valve_deadband", "hardening_spring")
    return fitted(search, names, {**PLANTED, "hardening_spring.coefficient": 1e6})


def test_what_dropping_a_member_costs_is_what_a_refit_finds(search, three):
    load, spring, _ = three.hypothesis.members
    assert (load.id, spring.id) == ("constant_load", "hardening_spring")
    false = refit_without(search, three, spring).fit.objective - three.fit.objective
    assert wald(three.fit, spring.effect) == pytest.approx(false, abs=2.0)
    assert wald(three.fit, load.effect) > 1e3


def test_what_earns_nothing_beside_the_others_is_dropped(search, three):
    assert prune(search, three).hypothesis.ids == ("constant_load", "valve_deadband")


def test_what_a_member_must_be_worth_rises_with_what_is_left(three):
    spring = three.hypothesis.members[1]
    worth = dict.fromkeys(three.hypothesis.members, 100000.0)
    at_the_noise = asked_of(spring, worth, three, 1e6)
    far = replace(three, fit=replace(three.fit, data=3.0 * three.fit.count))
    ratio = criteria.CONVINCING / (1.0 - criteria.CONVINCING)
    assert asked_of(spring, worth, far, 1e6) == pytest.approx(ratio * (2.0 - criteria.NOISE_KNOWN) * three.fit.count)
    assert at_the_noise < 0.02 * asked_of(spring, worth, far, 1e6)
    # what may pass for noise asks for nothing more than chance does
    quiet = replace(three, fit=replace(three.fit, data=(1.0 + 0.9 * criteria.NOISE_KNOWN) * three.fit.count))
    assert asked_of(spring, worth, quiet, 0.0) == by_chance(spring, worth, quiet)


def test_beside_a_law_of_several_forms_a_small_loss_is_believed_where_the_curvature_confirms_it(three):
    spring = three.hypothesis.members[1]
    quiet = replace(three, fit=replace(three.fit, data=float(three.fit.count)))
    shares = (criteria.OF_SAMPLES, criteria.OF_SAMPLES_BESIDE_A_FORM)
    least, more = (criteria.CHANCE + share * three.fit.count for share in shares)
    for worth, asked in ((1.01 * least, least), (0.99 * least, more)):
        worths = dict.fromkeys(three.hypothesis.members, worth)
        assert by_chance(spring, worths, quiet) == pytest.approx(asked)
    smooth = {one: 0.99 * least for one in three.hypothesis.members if one.id != "valve_deadband"}
    assert by_chance(spring, smooth, quiet) == pytest.approx(least)


def test_a_laws_form_leaves_something_for_what_acts_in_the_same_balance(three):
    members = {one.id: one for one in NOTHING.with_effects(LAWS.values()).members}
    friction, air, load, scale = (
        members[one] for one in ("presliding_friction", "entrained_air", "constant_load", "position_sensor_scale")
    )
    quiet = replace(three, fit=replace(three.fit, data=float(three.fit.count)))
    worth = {friction: 1e5, air: 1e5, load: 1e5, scale: 1e5}
    left = {member: asked_of(member, worth, quiet, 1e6) - by_chance(member, worth, quiet) for member in worth}
    assert left[load] == pytest.approx(criteria.OF_ITS_FORM * 1e5)  # the friction's form; air acts on the oil's flow
    assert left[air] == left[friction] == 0.0
    assert left[scale] == pytest.approx(criteria.OF_ITS_FORM * 2e5)


def test_a_search_ends_with_what_it_has_after_so_many_fits(search):
    nothing = search.again(Candidate(NOTHING, search.found[NOTHING]))
    alone = replace(search, found={NOTHING: nothing.fit}, effort=Effort())
    assert MOST_FITS == 700 and not alone.is_over and alone.leaves(nothing, criteria.NEAR_NOISE)
    grown = grow(alone, nothing)
    assert grown.hypothesis.ids == ("constant_load", "valve_deadband")
    assert len(alone.found) <= alone.effort.fits < MOST_FITS
    over = replace(search, found={NOTHING: nothing.fit}, effort=Effort(MOST_FITS))
    assert over.is_over and not over.leaves(nothing, criteria.NEAR_NOISE)
    assert grow(over, nothing) == nothing and list(over.found) == [NOTHING]
    scout = replace(over, found={}, short=True)  # what is tried over short windows counts, too
    assert scout.effort is over.effort


def test_a_fit_in_another_noise_is_the_same_model(search):
    best = fitted(search, ("constant_load", "valve_deadband"), PLANTED)
    again = Search(search.problem, search.applicable, search.scales, found=dict(search.found))
    louder = replace(best, fit=replace(best.fit, residuals=tuple(2.0 * one for one in best.fit.residuals)))
    again.measure_noise(louder)
    noises = zip(again.problem.shooting.samplings, search.problem.shooting.samplings, strict=True)
    assert all(now.noise == pytest.approx(2.0 * then.noise, rel=0.1) for now, then in noises)
    weighed = again.found[best.hypothesis]
    anew = fit(again.problem, best.fit.values, best.fit.free, best.fit.states, iterations=0)
    assert weighed.objective == pytest.approx(anew.objective, rel=1e-9)
    assert weighed.data == pytest.approx(anew.data, rel=1e-9)


def diagnosed(number, seed, names, noise):
    """A rig of the exam with these of its effects alone, and what a short test of it is diagnosed as.

    By the exam's truth, which shares neither equations nor integrator with the plant.
    """
    case = replace(
        draw_case("rig", number, seed),
        duration=8.0, rate=500.0, noise=noise, position_step=0.0, pressure_step=0.0, jitter=0.0, dropout=0.0,
    )  # fmt: skip
    case = replace(case, effects=tuple(one for one in case.effects if one[0] in names))
    units = {"voltage_command": "V", "position": "m", "pressure_a": "Pa", "pressure_b": "Pa"}
    channels = {
        name: Channel(name, time, values, units[name], name, "made")
        for name, (time, values) in measure(case, simulate_case(case)).items()
    }
    recording = Recording("made.mcap", channels, 0, case.duration, {}, (), None, ())
    return case, diagnose(recording, {**nominal_values(), **case.nominal})


def exactly(result, case):
    """Whether physics is said to be missing, and just what is concealed is named."""
    named = sorted(effect.id for effect in result.effects)
    return result.verdict == "missing_physics" and named == sorted(case.effect_ids)


def test_damping_beside_dry_friction_is_not_taken_for_stribecks_curve():
    """Stribeck's law explains both nearly, with as many parameters: damping then has little left to explain."""
    case, result = diagnosed(20, 11300, ("coulomb_friction", "quadratic_damping", "turbulent_leakage"), 10.0)
    assert exactly(result, case)


def test_three_effects_of_another_plant_are_named_and_nothing_else():
    case, result = diagnosed(3, 9001, ("coulomb_friction", "supply_pressure_droop", "constant_load"), 1.0)
    assert exactly(result, case)
    truth = dict(case.effects)
    load = next(effect for effect in result.effects if effect.id == "constant_load").parameters["force"]
    assert abs(load.value - float(truth["constant_load"]["force"])) < max(4.0 * load.std, 0.01 * abs(load.value))
    assert result.explained.complete
    assert max(result.explained.times_noise.values()) < 1.1
    assert all(result.prediction[name].ahead[0.25] < 1.5 * fit.noise for name, fit in result.held_out.items())


def test_noise_is_not_coherent_and_a_slow_rest_is():
    noise = np.random.default_rng(1).standard_normal(20_000)
    assert coherence(noise) == pytest.approx(1.0, abs=0.1)
    assert coherence(noise + np.sin(np.arange(20_000) / 500.0)) > 2.0
