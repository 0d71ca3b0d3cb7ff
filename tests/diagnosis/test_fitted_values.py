"""The prose of an effect takes its numbers from what the recording tells of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import LAWS, explanation

from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.fitted_values import named_effects, wald
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.comparison import Entry
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER


def named(values, covariance=None, intervals=None):
    """The one effect of these values, as the result has it; `covariance` [SI] of its parameters."""
    (name,) = {name.partition(".")[0] for name in values}
    free = free_effect_parameters(LAWS[name], {**nominal_values(), **values})
    scales = np.array([parameter.scale for parameter in free])
    spread = np.diag((0.01 * scales) ** 2) if covariance is None else covariance
    final = replace(explanation(values, free), covariance=spread / np.outer(scales, scales))
    winner = Entry(NOTHING.with_effects([LAWS[name]]), final, 100.0)
    (effect,) = named_effects(winner, final, PAPER, (), intervals or {})
    return effect


@pytest.mark.parametrize(
    ("ends", "said"),
    [
        ((1.2e4, None), "the seals rub: at least 12.0 kN of dry friction"),
        ((None, 1.9e4), "the seals rub: at most 19.0 kN of dry friction"),
        ((1.2e4, 1.9e4), "the seals rub: 18.00 kN of dry friction"),
        (None, "the seals rub: 18.00 kN of dry friction"),
    ],
)
def test_a_value_is_told_from_the_side_that_is_known(ends, said):
    effect = named({"coulomb_friction.force": 1.8e4}, intervals={"coulomb_friction.force": ends} if ends else {})
    assert effect.statement.startswith(said)
    assert effect.parameters["force"].interval == ends


def test_of_a_negative_value_the_magnitude_is_told():
    effect = named({"constant_load.force": -80.0}, intervals={"constant_load.force": (None, -50.0)})
    assert "at least 50.0 N" in effect.statement and "-" not in effect.statement.partition("at least")[2][:8]


@pytest.mark.parametrize(("sign", "word"), [(1.0, "difference"), (-1.0, "sum")])
def test_of_two_zeros_that_move_together_only_the_difference_is_told(sign, word):
    """Each give or take 1 MPa, but always alike, or opposite, but for 10 kPa."""
    shared, own = 1e6, 1e4
    block = shared**2 * np.array([[1.0, sign], [sign, 1.0]]) + own**2 * np.eye(2)
    values = {"pressure_sensor_bias.offset_a": 3e5, "pressure_sensor_bias.offset_b": -1e5}
    effect = named(dict(zip(_biases(), values.values(), strict=True)), block)
    known = {"difference": "400 kPa", "sum": "200 kPa"}[word]
    assert effect.statement.endswith(f"(of these two values only the {word} is known, {known})")


def test_of_two_values_that_are_told_each_is():
    values = dict(zip(_biases(), (3e5, -1e5), strict=True))
    assert "only the" not in named(values).statement
    far = 1e6**2 * np.array([[1.0, 0.5], [0.5, 1.0]])
    assert "only the" not in named(values, far).statement


def test_of_a_value_that_may_be_nothing_the_most_is_told():
    """The second bias has no more than its deviation."""
    effect = named(dict(zip(_biases(), (3e5, 1e4), strict=True)), np.diag([2e4, 2e4]) ** 2)
    assert effect.statement == "the pressure sensors are off: chamber A's by 300 kPa, chamber B's by at most 50.0 kPa"


def test_the_place_of_a_stop_that_was_not_met_is_not_told():
    values = {"lower": -1.7, "upper": 0.023, "stiffness": 7e6, "damping": 2500.0}
    full = {f"end_stop.{name}": value for name, value in values.items()}
    effect = named(full, np.diag([200.0, 1e-6, 1e4, 70.0]) ** 2)
    assert "below a value that is not known or above 23.00 mm" in effect.statement


@pytest.mark.parametrize("correlation", [0.0, 0.6])
def test_what_an_effect_is_worth_is_how_many_deviations_its_sizes_are_from_nothing(correlation):
    sizes, spread = np.array([3e5, -1e5]), np.array([2e4, 5e4])
    free = free_effect_parameters(LAWS["pressure_sensor_bias"], nominal_values())
    scales = np.array([parameter.scale for parameter in free])
    block = np.outer(spread, spread) * np.array([[1.0, correlation], [correlation, 1.0]])
    values = dict(zip(_biases(), sizes, strict=True))
    final = replace(explanation(values, free), covariance=block / np.outer(scales, scales))
    first, second = sizes / spread  # 15 and -2
    expected = (first**2 + second**2 - 2.0 * correlation * first * second) / (1.0 - correlation**2)
    assert wald(final, LAWS["pressure_sensor_bias"]) == pytest.approx(expected)


def _biases():
    return LAWS["pressure_sensor_bias"].parameter_names()
