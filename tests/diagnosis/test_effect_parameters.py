"""What a hypothesis pays for: the parameters that it makes use of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis.effect_parameters import free_effect_parameters, parameters_used
from eha_core.effects import effects

LAWS = {effect.id: effect for effect in effects()}


def fitted(values, deviations):
    """A fit of one effect with these values and standard deviations."""
    effect = LAWS[next(iter(values)).partition(".")[0]]
    starts = {name: row.typical or 1.0 for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}
    free = free_effect_parameters(effect, starts)
    spread = np.diag([(deviations[one.name] / one.slope(values[one.name])) ** 2 for one in free])
    base = explanation({})
    return replace(base, free=free, values={**base.values, **values}, covariance=spread)


@pytest.mark.parametrize(("rounding", "used"), [(1e-6, 1), (5e-5, 2)])
def test_a_deadband_with_sharp_edges_has_no_rounding_to_pay_for(rounding, used):
    values = {"valve_deadband.half_width": 2e-4, "valve_deadband.rounding": rounding}
    deviations = {"valve_deadband.half_width": 1e-6, "valve_deadband.rounding": 5e-6}
    assert parameters_used(fitted(values, deviations)) == used


def test_a_law_whose_shape_cannot_be_told_pays_for_it_all_the_same():
    values = {
        "stribeck_friction.force": 250.0,
        "stribeck_friction.static_force": 260.0,
        "stribeck_friction.stribeck_velocity": 5e-5,
        "stribeck_friction.shape": 2.0,
    }
    deviations = {"stribeck_friction.force": 1.0, "stribeck_friction.static_force": 400.0,
                  "stribeck_friction.stribeck_velocity": 1e-2,
                  "stribeck_friction.shape": 1.0}  # fmt: skip
    assert parameters_used(fitted(values, deviations)) == 4
