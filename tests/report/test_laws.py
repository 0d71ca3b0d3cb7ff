"""The laws in SI: the curves against their formulas, the points against the rig that made the recording."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from types import SimpleNamespace

import numpy as np
import pytest

from eha_core.diagnosis.result import Diagnosis, FittedValue, NamedEffect
from eha_core.effects import effects
from eha_core.plant import Plant
from eha_core.report.laws import Law
from eha_core.report.laws import laws as laws_by_effect


def laws(diagnosis: Diagnosis) -> tuple[Law, ...]:
    return tuple(laws_by_effect(diagnosis).values())


def named(identifier: str, values: dict[str, float], std: float = 0.0) -> NamedEffect:
    (declared,) = (effect for effect in effects() if effect.id == identifier)
    rows = {row.name: values.get(row.name, row.typical) for row in declared.parameters}
    fitted = {name: FittedValue(value, std if name in values else 0.0, "-") for name, value in rows.items()}
    return NamedEffect(identifier, declared.site, declared.equation, fitted, 100.0, declared.statement)


def law_of(diagnosis: Diagnosis, effect: NamedEffect) -> Law:
    (law,) = laws(replace(diagnosis, effects=(effect,)))
    return law


def test_friction_s_points_are_the_rig_s_and_lie_on_the_fitted_curve(friction: Diagnosis) -> None:
    (law,) = laws(friction)
    assert (law.across.unit, law.up.unit) == ("m/s", "N")
    damping = 2000.0
    expected = 200.4 * np.sign(law.x) + damping * law.x
    np.testing.assert_allclose(law.y, expected, rtol=1e-9)
    np.testing.assert_allclose(law.nominal, damping * law.x)
    np.testing.assert_allclose(law.high - law.y, 1.96 * 1.3, rtol=1e-6)
    # The recording was made with 200 N; a point's noise is that of the pressures' mean under its test function.
    true = 200.0 * np.sign(law.points_x) + damping * law.points_x
    assert len(law.points_x) > 50
    assert np.std(law.points_y - true) < 10.0
    assert abs(np.mean((law.points_y - true) * np.sign(law.points_x))) < 2.0


def test_points_come_from_the_data_and_not_from_the_fitted_law(friction: Diagnosis, simulated: SimpleNamespace) -> None:
    """A law that was fitted wrong, with the model of that law, leaves the points where the data have them."""
    wrong = replace(friction.effects[0], parameters={"force": FittedValue(120.0, 1.0, "N")})
    run = Plant({"coulomb_friction.force": 120.0}, 1e-4).run(simulated.voltage, 20)
    after = {name: getattr(run, f"measured_{name}") for name in friction.pictures.after}
    values = {**friction.fitted_values, "coulomb_friction.force": 120.0, "moving_mass": 9.0}
    (law,) = laws(
        replace(friction, effects=(wrong,), pictures=replace(friction.pictures, after=after), fitted_values=values)
    )
    fast = np.abs(law.points_x) > 0.3 * np.abs(law.points_x).max()
    true = 200.0 * np.sign(law.points_x) + 2000.0 * law.points_x
    assert np.median(np.abs((law.points_y - true)[fast])) < 15.0


@pytest.mark.parametrize(
    ("identifier", "values", "formula"),
    [
        ("directional_damping", {"ratio": 0.4}, lambda v: 2000.0 * v * (1.0 + 0.4 * np.sign(v))),
        ("quadratic_damping", {"coefficient": 900.0}, lambda v: 900.0 * v * np.abs(v) + 2000.0 * v),
        (
            "presliding_friction",
            {"force": 150.0, "static_force": 220.0, "stribeck_velocity": 0.02, "stiffness": 5e6, "damping": 900.0},
            lambda v: (150.0 + 70.0 * np.exp(-((v / 0.02) ** 2))) * np.sign(v) + 2000.0 * v,
        ),
        (
            "stribeck_friction",
            {"force": 150.0, "static_force": 220.0, "stribeck_velocity": 0.02},
            lambda v: (150.0 + 70.0 * np.exp(-((v / 0.02) ** 2))) * np.sign(v) + 2000.0 * v,
        ),
    ],
)
def test_forces_over_velocity_follow_their_formula(
    friction: Diagnosis, identifier: str, values: dict[str, float], formula: object
) -> None:
    law = law_of(friction, named(identifier, values))
    moving = np.abs(law.x) > 1e-3
    np.testing.assert_allclose(law.y[moving], formula(law.x[moving]), rtol=0.02)


def test_a_spring_is_drawn_over_position(friction: Diagnosis) -> None:
    law = law_of(friction, named("hardening_spring", {"coefficient": 3e8}))
    assert law.across.unit == "m"
    np.testing.assert_allclose(law.y, 3e8 * law.x**3 + 10.0 * law.x, rtol=1e-9, atol=1e-9)


def states(diagnosis: Diagnosis, simulated: SimpleNamespace) -> Diagnosis:
    """With the chambers' pressures among the states."""
    variables = dict(diagnosis.pictures.variables)
    variables |= {name: getattr(simulated.states, name) for name in ("pressure_a", "pressure_b")}
    return replace(diagnosis, pictures=replace(diagnosis.pictures, variables=variables))


def test_leakage_is_a_flow_over_the_pressure_difference(friction: Diagnosis, simulated: SimpleNamespace) -> None:
    law = law_of(states(friction, simulated), named("turbulent_leakage", {"coefficient": 2e-8}, std=1e-9))
    assert (law.across.unit, law.up.unit) == ("Pa", "m^3/s")
    wide = np.abs(law.x) > 2e4
    expected = 2e-8 * np.sign(law.x) * np.sqrt(np.abs(law.x)) + 1e-12 * law.x
    np.testing.assert_allclose(law.y[wide], expected[wide], rtol=1e-3)
    place = int(np.argmax(law.x))
    assert law.high[place] - law.y[place] == pytest.approx(1.96e-9 * sqrt(law.x[place]), rel=0.01)
    assert len(law.points_x) > 50


def test_a_worn_bore_is_a_leakage_over_the_position(friction: Diagnosis, simulated: SimpleNamespace) -> None:
    """The points come from the data: they lie on the rig's law where the fitted one has half its height."""
    shape = {"centre": 0.004, "width": 0.006}
    rows = {}
    for name, height in (("measured", 4e-10), ("after", 2e-10)):
        values = {"coefficient": height, **shape}
        run = Plant({f"bore_wear_leakage.{key}": value for key, value in values.items()}, 1e-4)
        found = run.run(simulated.voltage, 20)
        rows[name] = {key: getattr(found, f"measured_{key}") for key in friction.pictures.after}
    measured = {**friction.pictures.measured, **rows["measured"]}
    rig = replace(friction, pictures=replace(friction.pictures, measured=measured, after=rows["after"]))
    law = law_of(rig, named("bore_wear_leakage", {"coefficient": 2e-10, **shape}, std=1e-12))
    assert (law.across.unit, law.up.unit) == ("m", "m^3/(s Pa)")
    np.testing.assert_allclose(law.y, 1e-12 + 2e-10 / np.cosh((law.x - 0.004) / 0.006) ** 2, rtol=1e-9)
    np.testing.assert_allclose(law.nominal, 1e-12)
    true = 1e-12 + 4e-10 / np.cosh((law.points_x - 0.004) / 0.006) ** 2
    assert len(law.points_x) > 30
    assert np.median(np.abs(law.points_y - true)) < 2e-11


def test_a_deadband_is_an_opening_over_the_spool(friction: Diagnosis) -> None:
    law = law_of(friction, named("valve_deadband", {"half_width": 5e-5, "rounding": 0.0}))
    expected = np.sign(law.x) * np.maximum(np.abs(law.x) - 5e-5, 0.0)
    np.testing.assert_allclose(law.y, expected, rtol=1e-6, atol=1e-12)
    np.testing.assert_array_equal(law.nominal, law.x)


def test_a_parameter_that_rests_on_its_bound_does_not_widen_the_band(friction: Diagnosis) -> None:
    effect = named("valve_deadband", {"half_width": 5e-5, "rounding": 0.0}, std=1e-6)
    law = law_of(friction, effect)
    outside = np.abs(law.x) > 6e-5
    np.testing.assert_allclose((law.high - law.y)[outside], 1.96e-6, rtol=1e-3)


def test_a_sensor_s_error_and_a_supply_that_gives_way(friction: Diagnosis) -> None:
    law = law_of(friction, named("position_sensor_scale", {"ratio": 0.04}))
    np.testing.assert_allclose(law.y, 0.04 * law.x, rtol=1e-9)
    law = law_of(friction, named("supply_pressure_droop", {"resistance": 3e10, "time_constant": 0.05}))
    np.testing.assert_allclose(law.y, 2.1e7 - 3e10 * law.x, rtol=1e-3)


@pytest.mark.parametrize("time_constant", [0.01, 20.0, 100.0])
def test_a_supply_s_law_is_the_steady_one_however_slowly_it_settles(friction: Diagnosis, time_constant: float) -> None:
    values = {"resistance": 3e10, "time_constant": time_constant}
    law = law_of(friction, named("supply_pressure_droop", values))
    np.testing.assert_allclose(law.y, law.nominal - 3e10 * law.x, rtol=1e-9)


def test_every_effect_of_the_catalogue_can_be_drawn_or_has_no_law(
    friction: Diagnosis, simulated: SimpleNamespace
) -> None:
    without = set()
    for effect in (one for one in effects() if one.named):
        found = laws(replace(states(friction, simulated), effects=(named(effect.id, {}),)))
        if not found:
            without.add(effect.id)
        for law in found:
            assert np.all(np.isfinite(law.y)) and np.all(law.low <= law.high)
    no_function = {"command_delay", "spool_hysteresis", "position_sensor_lag", "position_sensor_backlash"}
    assert without == no_function | {"pressure_sensor_lag", "valve_null_leakage", "unequal_piston_area"}


def test_many_effects_have_a_law_each(friction: Diagnosis) -> None:
    many = tuple(
        named(one, {}) for one in ("coulomb_friction", "quadratic_damping", "constant_load", "hardening_spring",
                                   "valve_deadband", "valve_null_offset", "position_sensor_scale", "end_stop")
    )  # fmt: skip
    assert len(laws(replace(friction, effects=many))) == 8
