"""Exponential, logarithm and power against NumPy's, in a loop of vectors and one by one."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from numba import njit

from eha_core import elementary

ULP = np.finfo(float).eps


@njit(error_model="numpy")
def exp_of_each(numbers, out):
    for k in range(len(numbers)):
        out[k] = elementary.exp(numbers[k])


@njit(error_model="numpy")
def log_of_each(numbers, out):
    for k in range(len(numbers)):
        out[k] = elementary.log(numbers[k])


@njit(error_model="numpy")
def power_of_each(numbers, exponent, out):
    for k in range(len(numbers)):
        out[k] = elementary.power(numbers[k], exponent)


def of_each(function, numbers, *rest):
    out = np.empty(len(numbers))
    function(np.array(numbers, dtype=float), *rest, out)
    return out


def uniform(low, high):
    return np.random.default_rng(7).uniform(low, high, 100_000)


@pytest.mark.parametrize("numbers", [uniform(-707.0, 708.0), uniform(-1.0, 1.0), uniform(-1e-9, 1e-9), [0.0, -0.0]])
def test_the_exponential_is_right_to_two_units_in_the_last_place(numbers):
    np.testing.assert_allclose(of_each(exp_of_each, numbers), np.exp(numbers), rtol=2.0 * ULP)


@pytest.mark.parametrize(
    "numbers", [np.exp(uniform(-700.0, 700.0)), 1.0 + uniform(-0.5, 1.0), 1.0 + uniform(0.0, 1e-9), [1.0]]
)
def test_the_logarithm_is_right_to_three_units_in_the_last_place(numbers):
    np.testing.assert_allclose(of_each(log_of_each, numbers), np.log(numbers), rtol=3.0 * ULP)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.0 / 1.4, 2.0, 4.0])
def test_a_power_is_right_to_as_many_as_its_logarithm_is_large(exponent):
    numbers = np.exp(uniform(-100.0, 5.0))
    np.testing.assert_allclose(of_each(power_of_each, numbers, exponent), numbers**exponent, rtol=400.0 * ULP)


def test_outside_of_normal_numbers_they_are_held():
    assert of_each(exp_of_each, [-1e9, -np.inf]).tolist() == [of_each(exp_of_each, [-708.0])[0]] * 2
    assert of_each(exp_of_each, [1e9, np.inf]).tolist() == [of_each(exp_of_each, [709.0])[0]] * 2
    assert of_each(log_of_each, [0.0])[0] == pytest.approx(-709.1, abs=0.05)
    assert 0.0 < of_each(power_of_each, [0.0], 0.5)[0] < 1e-150


@pytest.mark.parametrize(("function", "rest"), [(exp_of_each, ()), (log_of_each, ()), (power_of_each, (1.7,))])
def test_a_number_alone_has_the_same_bits_as_in_a_loop_of_vectors(function, rest):
    numbers = uniform(0.0, 30.0)[:1001]
    together = of_each(function, numbers, *rest)
    assert together.tolist() == [of_each(function, [one], *rest)[0] for one in numbers]


@pytest.mark.parametrize(("function", "rest"), [(exp_of_each, ()), (log_of_each, ()), (power_of_each, (1.7,))])
def test_the_interpreter_finds_the_same_bits(function, rest):
    numbers = uniform(0.0, 30.0)[:300]
    name = function.__name__.removesuffix("_of_each")
    rest_of = ", " + ", ".join(map(str, rest)) if rest else ""
    program = f"from eha_core.elementary import {name}\nprint([{name}(x{rest_of}) for x in {numbers.tolist()}])"
    ended = subprocess.run(
        [sys.executable, "-c", program], env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    assert json.loads(ended.stdout) == of_each(function, numbers, *rest).tolist()
