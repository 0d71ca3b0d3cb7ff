"""The test that is proposed to tell two explanations apart does so, and is one that the rig can bear."""

import re

import numpy as np
import pytest
from made import explanation

from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.design import propose
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.parameters import nominal_values
from eha_core.plant import Plant
from eha_core.signals import make_signal

NOISE = {"position": 1e-5}
LIMIT = 2.0
SAMPLE = 1e-3


def voltage_of(experiment):
    reference = experiment.reference
    prefix = reference["signal"] + "."
    parameters = {name.removeprefix(prefix): value for name, value in reference.items() if name.startswith(prefix)}
    return make_signal(reference["signal"], parameters).value(np.arange(round(experiment.duration / 2e-4)) * 2e-4)


def driven(changes, experiment):
    return Plant({**nominal_values(), **changes}, 2e-4).run(voltage_of(experiment), round(SAMPLE / 2e-4))


def deviations(experiment):
    return float(re.search(r"expected: (\d+) deviations", experiment.statement).group(1))


LOAD, ASYMMETRY = {"constant_load.force": 200.0}, {"flow_gain_asymmetry.ratio": -0.015}


def test_the_outcome_differs_by_what_is_predicted():
    rivals = [(("constant_load",), explanation(LOAD)), (("flow_gain_asymmetry",), explanation(ASYMMETRY))]
    experiment = propose(rivals, NOISE, 0.1, LIMIT)
    assert experiment.separates == ("constant_load", "flow_gain_asymmetry")
    assert experiment.reference["mode"] == "voltage"
    one, two = (driven(changes, experiment).measured_position for changes in (LOAD, ASYMMETRY))
    apart = (two - one).reshape(-1, 1000) / NOISE["position"]  # as a fit, which starts again every second
    apart -= apart.mean(axis=1, keepdims=True)
    assert np.sqrt(np.sum(apart**2)) == pytest.approx(deviations(experiment), rel=0.01)
    assert experiment.statement.startswith("constant load or flow gain asymmetry: a ")
    assert "should tell them apart" in experiment.statement
    amplitude, unit = re.search(r"amplitude ([0-9.]+) (\w+)", experiment.statement).groups()
    stated = float(amplitude) * {"V": 1.0, "mV": 1e-3}[unit]
    assert stated == pytest.approx(np.max(np.abs(voltage_of(experiment))), rel=0.01)


def test_what_the_nominal_parameters_could_imitate_does_not_count():
    known = [(("constant_load",), explanation(LOAD)), (("flow_gain_asymmetry",), explanation(ASYMMETRY))]
    free = free_nominal_parameters(nominal_values(), "voltage", 0.02)
    fitted = [(known[0][0], explanation(LOAD, free)), known[1]]
    assert deviations(propose(fitted, NOISE, 0.1, LIMIT)) < 0.9 * deviations(propose(known, NOISE, 0.1, LIMIT))


def test_pressures_are_asked_for_where_no_voltage_tells():
    free = free_nominal_parameters(nominal_values(), "voltage", 0.02)
    load, area = {"constant_load.force": 1.0}, {"unequal_piston_area.ratio": 0.99986}
    rivals = [(("constant_load",), explanation(load, free)), (("unequal_piston_area",), explanation(area))]
    experiment = propose(rivals, NOISE, 0.1, LIMIT)
    assert experiment.record == ("pressure_a", "pressure_b")
    assert "pressures recorded too" in experiment.statement
    assert propose(rivals, {**NOISE, "pressure_a": 1e4, "pressure_b": 1e4}, 0.1, LIMIT).record == ()


def biased(pressure):
    """Two explanations whose outcomes differ by a constant pressure [Pa] alone."""
    return [((), explanation({})), (("pressure_sensor_bias",), explanation({"pressure_sensor_bias.bias_a": pressure}))]


def test_a_mean_pressure_tells():
    experiment = propose(biased(1500.0), {**NOISE, "pressure_a": 1e4, "pressure_b": 1e4}, 0.1, LIMIT)
    assert experiment.duration == 10.0
    assert deviations(experiment) == round(0.15 * np.sqrt(10.0 * 1000.0))


def test_a_faint_difference_takes_longer():
    experiment = propose(biased(700.0), {**NOISE, "pressure_a": 1e4, "pressure_b": 1e4}, 0.1, LIMIT)
    assert experiment.duration == 40.0
    assert deviations(experiment) == round(0.07 * np.sqrt(40.0 * 1000.0))
    assert "for 40 s" in experiment.statement


def test_the_rig_can_bear_the_test():
    rig = {"actuator_displacement": 0.004, "supply_pressure": 7e6}
    rivals = [(("constant_load",), explanation(LOAD | rig)), (("flow_gain_asymmetry",), explanation(ASYMMETRY | rig))]
    experiment = propose(rivals, NOISE, 0.5, LIMIT)
    assert abs(experiment.reference[f"{experiment.reference['signal']}.amplitude"]) <= LIMIT
    rows = driven(LOAD | rig, experiment)
    assert np.max(np.abs(rows.position)) < 0.85 * 0.004
    for pressure in (rows.pressure_a, rows.pressure_b):
        assert pressure.min() > -101325.0
        assert pressure.max() < 1.2 * 7e6


def test_limits_that_are_given_hold_in_place_of_the_model_s():
    limits = Limits(position=0.004, speed=0.05, pressure=12e6, energy=400.0, voltage=0.3)
    rivals = [(("constant_load",), explanation(LOAD)), (("flow_gain_asymmetry",), explanation(ASYMMETRY))]
    experiment = propose(rivals, NOISE, 0.1, 0.3, limits)
    for changes in (LOAD, ASYMMETRY):
        rows = driven(changes, experiment)
        assert max(limits.shares(rows.values, SAMPLE, 101325.0).values()) < 1.01
    assert experiment.expected == pytest.approx(deviations(experiment) ** 2, rel=0.02)


def test_a_proposed_signal_is_read_back_from_the_reference_node_s_parameters():
    signal = CommandSignal("square", {"amplitude": 0.2, "frequency": 0.25})
    assert CommandSignal.of({**signal.reference(), "duration": 10.0}) == signal
