"""What a test is expected to tell leaves out what parameters can imitate, however far they have to go."""

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis.experiment.discrimination import STEP, separation
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.parameters import nominal_values

NOISE = {"position": 1e-5, "pressure_a": 1e4, "pressure_b": 1e4}
VOLTAGE = 0.5 * np.sin(2.0 * np.pi * 3.0 * np.arange(round(4.0 / STEP)) * STEP)
ELSEWHERE = {"valve_gain": 1.04, "moving_mass": 0.95, "damping_coefficient": 1.05, "bulk_modulus": 0.96}


def test_rivals_that_differ_in_parameters_alone_are_not_told_apart():
    nominal = nominal_values()
    free = free_nominal_parameters(nominal, "voltage", 0.02)
    moved = {name: factor * nominal[name] for name, factor in ELSEWHERE.items()}
    held = separation(VOLTAGE, [explanation({}), explanation(moved)], NOISE)
    assert held > 1e5
    assert separation(VOLTAGE, [explanation({}, free), explanation(moved, free)], NOISE) < 5.0


def test_the_two_that_are_hardest_to_tell_count():
    rivals = [explanation({}), explanation({"constant_load.force": 200.0}), explanation({"constant_load.force": 201.0})]
    near = separation(VOLTAGE, rivals[1:], NOISE)
    assert separation(VOLTAGE, rivals[:2], NOISE) > 100.0 * near
    assert separation(VOLTAGE, rivals, NOISE) == pytest.approx(near, rel=1e-9)


def test_a_test_that_the_rig_would_not_bear_tells_nothing():
    assert separation(VOLTAGE, [explanation({}), explanation({"actuator_displacement": 1e-3})], NOISE) is None
