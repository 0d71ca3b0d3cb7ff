"""Dry friction read off the force balance, of plants whose answer is known and whose flow side may be anything."""

from dataclasses import replace

import pytest
from made import recorded

from eha_core.identification.observation import observe
from eha_core.parameters import nominal_values
from eha_core.weak_form.dry_friction import CLEAR, dry_friction

COULOMB = {"coulomb_friction.force": 250.0}
STRIBECK = {
    "stribeck_friction.force": 400.0,
    "stribeck_friction.static_force": 600.0,
    "stribeck_friction.stribeck_velocity": 0.03,
}
LONG = {"duration": 12.0, "rate": 1000.0, "amplitude": 0.25}
FAST = {**LONG, "amplitude": 1.0}
"""A motion that covers the speeds between which Stribeck's curve falls; a slower one hardly leaves the lower end."""
FLOW = {
    "a valve that overlaps": {"valve_deadband.half_width": 1e-4},
    "a leak": {"turbulent_leakage.coefficient": 3e-8, "external_leakage.coefficient_a": 2e-12},
    "another gain and supply": {"valve_gain": 0.7 * nominal_values()["valve_gain"], "supply_pressure": 1.5e7},
    "nothing": {},
}


def found(parameters, nominal=None, **how):
    return dry_friction(
        observe(recorded({**(nominal or {}), **parameters}, **how)), {**nominal_values(), **(nominal or {})}
    )


def of(forms, name):
    return next(form for form in forms if form.form == name)


@pytest.mark.parametrize("flow", FLOW)
def test_coulombs_friction_is_measured_whatever_is_wrong_with_the_flow(flow):
    forms = found({**COULOMB, **FLOW[flow]}, **LONG)
    assert forms[0].form in ("coulomb_friction", "stribeck_friction")
    coulomb = of(forms, "coulomb_friction")
    assert coulomb.clear < CLEAR, "its own form is not refused"
    assert coulomb.values["force"] == pytest.approx(250.0, rel=0.03)
    assert of(forms, "").clear > CLEAR


@pytest.mark.parametrize("flow", FLOW)
def test_stribecks_curve_is_told_from_coulombs_friction(flow):
    forms = found({**STRIBECK, **FLOW[flow]}, **FAST)
    assert forms[0].form == "stribeck_friction"
    assert of(forms, "coulomb_friction").clear > CLEAR and of(forms, "").clear > CLEAR
    values = forms[0].values
    assert values["force"] == pytest.approx(400.0, rel=0.1)
    assert values["static_force"] == pytest.approx(600.0, rel=0.1)
    assert values["stribeck_velocity"] == pytest.approx(0.03, rel=0.15)


def test_a_piston_that_sticks_and_slips_within_a_test_function_is_not_taken_for_one_that_creeps():
    heavy = {"moving_mass": 30.0}
    rubbing = {
        "stribeck_friction.force": 540.0,
        "stribeck_friction.static_force": 1000.0,
        "stribeck_friction.stribeck_velocity": 0.017,
    }
    forms = found(rubbing, heavy, duration=12.0, rate=1000.0, amplitude=0.1, sine=0.25)
    assert forms[0].form == "stribeck_friction"
    for name, value in rubbing.items():
        assert forms[0].values[name.partition(".")[2]] == pytest.approx(value, rel=0.15)


@pytest.mark.parametrize("flow", FLOW)
def test_where_there_is_no_friction_none_is_clear(flow):
    forms = found(FLOW[flow], **LONG)
    assert of(forms, "").clear < CLEAR


def test_friction_that_follows_the_load_is_told_under_a_spring():
    spring = {"spring_stiffness": 2e4}
    planted = {"load_friction.coefficient": 2e-4}
    forms = found(planted, spring, **FAST)
    assert forms[0].form == "load_friction"
    assert forms[0].values["coefficient"] == pytest.approx(2e-4, rel=0.03)
    assert of(forms, "coulomb_friction").clear > CLEAR


def test_mass_and_damping_need_not_be_known():
    other = {"moving_mass": 14.0, "damping_coefficient": 3000.0}
    forms = found({**COULOMB, **other}, **LONG)
    assert of(forms, "coulomb_friction").values["force"] == pytest.approx(250.0, rel=0.03)


def test_without_both_pressures_or_motion_there_is_no_answer():
    observation = observe(recorded(COULOMB, duration=4.0))
    for missing in ("position", "pressure_a", "pressure_b"):
        rest = tuple(channel for channel in observation.measured if channel.name != missing)
        assert dry_friction(replace(observation, measured=rest), nominal_values()) == ()
    position = observation.channel("position")
    still = replace(position, values=position.values[0] + 0.0 * position.values)
    channels = tuple(still if channel is position else channel for channel in observation.measured)
    assert dry_friction(replace(observation, measured=channels), nominal_values()) == ()
