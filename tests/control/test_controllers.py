"""Every controller in a loop with the plant: it follows, recovers from its limit, and starts anew after a reset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from eha_core.control import CONTROLLERS, Measurement, Target, make_controller
from eha_core.control.integrator import Integrator
from eha_core.control.linear_model import velocity_gain
from eha_core.control.loop import follow
from eha_core.control.scoring import score
from eha_core.errors import ParameterError
from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant
from eha_core.signals import make_signal, signals

PERIOD, LARGEST = 0.002, 10.0
FRICTION = {"moving_mass": 11.0, "coulomb_friction.force": 250.0}
CONTROL = Path(__file__).resolve().parents[2] / "eha_description" / "config" / "controllers.yaml"


def sine(amplitude: float = 0.01, frequency: float = 1.0):
    given = {"amplitude": amplitude, "frequency": frequency}
    return make_signal("sine", {row.name: given.get(row.name, row.default) for row in signals()["sine"].parameters()})


def rmse(name: str, rig: dict[str, float], known: dict[str, float], amplitude: float = 0.01) -> float:
    controller = make_controller(name, changed(nominal_values(), known), PERIOD, LARGEST)
    return follow(controller, Plant(rig), sine(amplitude), seconds=3.0, period=PERIOD, skip=1.0).rmse


@pytest.mark.parametrize("name", [name for name in CONTROLLERS if name != "pid"])
def test_what_knows_the_reference_s_velocity_beats_the_pid_on_every_rig(name: str) -> None:
    for rig in ({}, {"internal_leakage": 1e-10}, FRICTION):
        assert rmse(name, rig, {}) < 0.5 * rmse("pid", rig, {})


def test_the_pid_leaves_what_its_loop_gain_leaves() -> None:
    """The error of a loop is the reference over one plus the loop's gain, here by the valve's gain and coil alone."""
    s = 2j * np.pi * 1.0
    values = nominal_values()
    gain, lag = 60.0 / velocity_gain(values), values["coil_inductance"] / values["coil_resistance"]
    actuator = velocity_gain(values) / (s * (1 + lag * s))
    law, damping = gain * (1 + 1 / (0.1 * s)), gain * lag * s
    closed = actuator * law / (1 + actuator * (law + damping))
    expected = 0.01 * abs(1 - closed) / np.sqrt(2)
    assert rmse("pid", {}, {}) == pytest.approx(expected, rel=0.05)


def test_feedforward_from_a_diagnosis_beats_the_pid_threefold_on_a_rig_with_friction() -> None:
    diagnosed = rmse("feedforward", FRICTION, FRICTION)
    assert diagnosed < rmse("pid", FRICTION, {}) / 3
    assert diagnosed < rmse("feedforward", FRICTION, {}) / 3  # it is the friction found that tells
    assert rmse("feedforward", {}, {}) < 2e-6


@pytest.mark.parametrize("name", list(CONTROLLERS))
def test_a_reference_out_of_reach_leaves_no_windup(name: str) -> None:
    """Held at the stroke's end for some time by a reference beyond it, the piston comes back without a swing."""
    controller, plant = make_controller(name, nominal_values(), PERIOD, 0.05), Plant()
    positions = []
    for number in range(3000):
        wanted = 0.5 if number < 1500 else 0.0
        state = plant.state
        measured = Measurement(state.position, state.velocity, state.hydraulic_force)
        plant.advance(controller.voltage(measured, Target(wanted, 0.0)), 20)
        positions.append(state.position)
    assert max(positions) == pytest.approx(0.1, rel=0.01)
    assert min(positions) > -0.01
    assert abs(positions[-1]) < 1e-3


@pytest.mark.parametrize("name", list(CONTROLLERS))
def test_a_reset_makes_the_same_run_again(name: str) -> None:
    controller = make_controller(name, nominal_values(), PERIOD, LARGEST)
    runs = []
    for _ in range(2):
        controller.reset()
        runs.append(follow(controller, Plant(), sine(), seconds=0.5, period=PERIOD, skip=0.0))
    assert runs[0] == runs[1]


def test_an_unknown_controller_is_named() -> None:
    with pytest.raises(ParameterError, match="controller = 'pdi' is unknown; give one of pid, cascade"):
        make_controller("pdi", nominal_values(), PERIOD, LARGEST)


def test_an_integral_stands_while_the_drive_is_at_its_limit() -> None:
    integral = Integrator(period=0.1, largest=1.0)
    integral.add(2.0, voltage=0.5)
    integral.add(2.0, voltage=1.5)  # pushed further: left out
    integral.add(-1.0, voltage=1.5)  # leads back: taken
    assert integral.value == pytest.approx(0.1)


def test_a_run_is_scored_as_by_hand() -> None:
    ones = np.ones(4)
    made = score(
        error=np.array([3e-3, -4e-3, 0.0, 0.0]),
        voltage=np.array([0.0, 1.0, -1.0, -1.0]),
        flow_a=np.array([1e-4, -1e-4, 0.0, 0.0]),
        flow_b=np.array([1e-4, -2e-4, 0.0, 0.0]),
        supply_pressure=2e7 * ones,
        period=0.5,
    )
    assert made.rmse == pytest.approx(2.5e-3) and made.largest_error == 4e-3
    assert made.energy == pytest.approx(2e7 * (1e-4 + 2e-4) * 0.5)
    assert made.chattering == pytest.approx(3.0 / 2.0)


@pytest.mark.parametrize("section", ["joint_trajectory_controller", "pid_controller"])
def test_the_gains_for_ros2_control_follow_a_trajectory(section: str) -> None:
    """u = p e + i integral of e + feedforward v_r, as these controllers compute it at 500 Hz."""
    document = yaml.safe_load(CONTROL.read_text())
    gains = document[f"/**/{section}"]["ros__parameters"]["gains"]["piston"]
    ahead = gains.get("feedforward_gain", gains.get("ff_velocity_scale"))
    plant, reference, integral, errors = Plant(), sine(), 0.0, []
    for number in range(1500):
        time = number * PERIOD
        error = float(reference.value(time)) - plant.state.position
        integral += error * PERIOD
        volts = gains["p"] * error + gains["i"] * integral + ahead * float(reference.derivative(time))
        assert abs(volts) < gains["u_clamp_max"]
        plant.advance(volts, 20)
        errors.append(error)
    assert np.sqrt(np.mean(np.square(errors[500:]))) < 1e-4  # a hundredth of the amplitude
