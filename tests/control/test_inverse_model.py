"""The inverse against the simulator: its voltage, without feedback, moves a plant with these effects as wanted."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.control import Measurement, Target, make_controller
from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant

PERIOD = 1e-3
EFFECTS = {
    "load": {"constant_load.force": 3000.0},
    "null offset": {"valve_null_offset.offset": 2e-4},
    "dry friction": {"coulomb_friction.force": 800.0},
    "Stribeck friction": {
        "stribeck_friction.force": 500.0, "stribeck_friction.static_force": 800.0,
        "stribeck_friction.stribeck_velocity": 0.2,
    },
    "presliding friction": {"presliding_friction.force": 800.0, "presliding_friction.static_force": 900.0},
    "viscous friction by direction": {"damping_coefficient": 6000.0, "directional_damping.ratio": 0.8},
    "friction with the square of the speed": {"quadratic_damping.coefficient": 2e5},
    "stiffening spring": {"spring_stiffness": 1e5, "hardening_spring.coefficient": 2e9},
    "overlap": {"valve_deadband.half_width": 2e-4, "valve_deadband.rounding": 2e-5},
    "weak towards retraction": {"flow_gain_asymmetry.ratio": 0.3},
    "saturating flow": {"flow_saturation.curvature": 500.0},
    "internal leakage": {"internal_leakage": 1e-11, "constant_load.force": 3000.0},
    "turbulent leakage": {"turbulent_leakage.coefficient": 3e-8, "constant_load.force": 3000.0},
    "external leakage": {"external_leakage.coefficient_a": 1e-12},
    "rod in chamber B": {"unequal_piston_area.ratio": 0.6},
    "late command": {"command_delay.delay": 5e-3},
}  # fmt: skip


def velocity_error(rig: dict[str, float], known: dict[str, float]) -> float:
    """RMS of the velocity's error over that of the velocity, in the second period of a sine of 10 mm and 2 Hz.

    A quarter about each reversal is left out: no voltage keeps a piston from resting under dry friction there.
    """
    controller = make_controller("feedforward", changed(nominal_values(), known), PERIOD, 10.0)
    plant, errors, wanted = Plant(rig, initial_position=0.01), [], []
    for phase in 4.0 * np.pi * PERIOD * np.arange(1000):
        target = Target(0.01 * np.cos(phase), -0.04 * np.pi * np.sin(phase))
        plant.advance(controller.voltage(Measurement(target.position, target.velocity, 0.0), target), 10)
        after = np.sin(phase + 4.0 * np.pi * PERIOD)
        if phase >= 2.0 * np.pi and abs(after) > 0.4:
            wanted.append(-0.04 * np.pi * after)
            errors.append(plant.state.velocity - wanted[-1])
    return float(np.sqrt(np.mean(np.square(errors)) / np.mean(np.square(wanted))))


@pytest.mark.parametrize("effect", EFFECTS)
def test_what_is_known_of_the_actuator_is_compensated(effect: str) -> None:
    rig = EFFECTS[effect]
    assert velocity_error(rig, rig) < 0.3 * velocity_error(rig, {})
