"""Friction in a set is begun anew over short windows where long ones have led it to a law that it is not."""

from dataclasses import replace

import pytest
from made import recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.criteria import UNFITTED
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.initial_guesses import applicable_effects
from eha_core.diagnosis.search.short_windows import LED, STICKING, set_in_each_form, set_with_friction, sticks
from eha_core.effects import effects
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

LAWS = {effect.id: effect for effect in effects()}
PLANTED = {
    "constant_load.force": 300.0,
    "stribeck_friction.force": 400.0,
    "stribeck_friction.static_force": 580.0,
    "stribeck_friction.stribeck_velocity": 0.03,
}
LOST = {
    "stribeck_friction.force": 300.0,
    "stribeck_friction.static_force": 520.0,
    "stribeck_friction.stribeck_velocity": 0.001,
}


@pytest.fixture(scope="module")
def search():
    observation = observe(recorded(PLANTED, duration=6.0))
    calibration = calibrate([observation], NominalModel(nominal_values()), 2e-4)
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    made = Search(calibration.problem, applicable_effects([observation]), scales, shorter=calibration.shorter)
    made.keep(NOTHING, calibration.fitted)
    return made


def fitted(search, values, iterations):
    chosen = [LAWS[name] for name in sorted({name.split(".")[0] for name in values if "." in name})]
    begun = {**nominal_values(), **values}
    free = with_effects(search.found[NOTHING].free, chosen, begun)
    return search.try_proposal(Proposal(NOTHING.with_effects(chosen), begun, free, None), iterations)


def test_a_law_that_has_lost_its_shape_is_led_back(search):
    lost = fitted(search, {**PLANTED, **LOST}, 17)
    assert lost.times_noise > UNFITTED
    led = set_with_friction(search, lost)
    assert led.hypothesis == lost.hypothesis and led.times_noise < 1.05
    assert led.fit.values["stribeck_friction.stribeck_velocity"] == pytest.approx(0.03, rel=0.1)


def test_where_another_form_was_taken_the_rigs_own_is_found_beside_the_other_members(search):
    found = dict(search.found)
    other = fitted(search, {"constant_load.force": 300.0, "coulomb_friction.force": 400.0}, 20)
    assert other.times_noise > UNFITTED
    search.found = {NOTHING: found[NOTHING], other.hypothesis: other.fit}
    led = set_in_each_form(search, other)
    led_on = search.found.keys() - {NOTHING, other.hypothesis}
    search.found = found
    assert 1 <= len(led_on) <= LED < len([effect for effect in LAWS.values() if effect.kind == STICKING])
    assert led.hypothesis.ids == ("constant_load", "stribeck_friction") and led.times_noise < 1.05


def test_what_bent_the_nominal_values_is_forgotten(search):
    """The load and the friction at their own values beside a mass and a bulk modulus far from the rig's."""
    chosen = [LAWS["constant_load"], LAWS["stribeck_friction"]]
    values = {**nominal_values(), **PLANTED, "moving_mass": 40.0, "bulk_modulus": 5e8}
    free = with_effects(search.found[NOTHING].free, chosen, values)
    bent = Candidate(NOTHING.with_effects(chosen), fit(search.problem, values, free, iterations=0))
    assert bent.times_noise > UNFITTED
    led = set_with_friction(replace(search, found={}), bent)
    assert led.times_noise < 1.05
    assert led.fit.values["moving_mass"] == pytest.approx(nominal_values()["moving_mass"], rel=0.1)


def test_a_set_that_cannot_stick_is_left_as_it_is(search):
    load = fitted(search, {"constant_load.force": 300.0}, 3)
    assert not sticks(load.hypothesis) and set_with_friction(search, load) is load
