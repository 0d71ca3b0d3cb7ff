"""Values that are off by one factor are one scale; the plant itself says by which powers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis.common_scale import AREA, CLOCK, POSITION, POWERS, PRESSURES, common_scale
from eha_core.diagnosis.result import FittedParameter
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.parameters import nominal_values
from eha_core.plant import Plant

NOMINAL = nominal_values() | {"spring_stiffness": 2e4, "return_pressure": 0.0, "internal_leakage": 2e-11}
FREE = tuple(parameter for parameter in free_nominal_parameters(NOMINAL, "voltage", 0.05) if parameter.logarithmic)


def fitted(factors, deviation=0.01):
    """A fit whose parameters are so many times the nominal ones, each give or take a hundredth; and its rows."""
    q = np.array([np.log(factors.get(parameter.name, 1.0)) for parameter in FREE])
    values = {parameter.name: parameter.value(float(at)) for parameter, at in zip(FREE, q, strict=True)}
    result = replace(
        explanation({}), free=FREE, q=q, values=values, covariance=deviation**2 * np.eye(len(FREE))
    )  # fmt: skip
    rows = [
        FittedParameter(name, NOMINAL[name], value, deviation * value, "-", abs(value / NOMINAL[name] - 1.0) > 0.04)
        for name, value in values.items()
    ]
    return result, rows


@pytest.mark.parametrize("of", POWERS)
@pytest.mark.parametrize("factor", [0.8, 1.3])
def test_each_scale_is_told_from_the_others(of, factor):
    result, rows = fitted({name: factor**power for name, power in POWERS[of].items()})
    found = common_scale(result, rows)
    assert found is not None and found.of == of
    assert found.factor == pytest.approx(factor, rel=0.01)
    assert 0.0 < found.std < 0.02


def test_values_that_differ_by_factors_of_their_own_are_many_changes():
    clock = {name: 1.3**power for name, power in POWERS[CLOCK].items()}
    assert common_scale(*fitted(clock | {"moving_mass": 1.0})) is None
    assert common_scale(*fitted(clock | {"bulk_modulus": 1.3})) is None
    assert common_scale(*fitted({"moving_mass": 1.69, "damping_coefficient": 1.3})) is None  # two tell no factor
    assert common_scale(*fitted({})) is None


def run(values, slower=1.0):
    """Position and pressures of a plant at 40 moments of a test that takes so many times as long, 0.2 s nominally."""
    volts = np.repeat([0.5, -0.5, 0.2, 0.0], 500)
    plant = Plant({"spring_stiffness": 2e4, "internal_leakage": 2e-11, "line_volume": 1e-7, **values}, 1e-4 * slower)
    seen = plant.run(volts, 50)
    return np.stack([seen.position, seen.pressure_a, seen.pressure_b])


@pytest.mark.parametrize(("of", "units"), [
    (CLOCK, (1.0, 1.0)), (POSITION, (1.25, 1.0)), (PRESSURES, (1.0, 1.25)), (AREA, (1.0, 1.0)),
])  # fmt: skip
def test_the_plant_keeps_its_form_under_each_scale(of, units):
    """Changed by the powers, its parameters make the nominal answer in the other unit, or that of the other area."""
    changed = {name: NOMINAL[name] * 1.25**power for name, power in POWERS[of].items()}
    other = {"piston_area": 1.25 * 645e-6, "piston_area_b": 1.25 * 645e-6} if of == AREA else {}
    true, changed_values = run(other), run(changed, slower=1.25 if of == CLOCK else 1.0)
    for seen, expected, unit in zip(changed_values, true, (units[0], units[1], units[1]), strict=True):
        assert np.ptp(expected) > 1e-4
        assert np.max(np.abs(seen - unit * expected)) < 0.01 * unit * np.ptp(expected)
    assert np.max(np.abs(run({})[0] - true[0])) > 0.01 * np.ptp(true[0]) or of != AREA
