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
}


def velocity_error(rig: dict[str, float], known: dict[str, float]) -> float:
    """RMS of the velocity's error over that of the velocity, in the second period of a sine of 10 mm and 2 Hz."""
    controller, plant = make_controller("feedforward", changed(nominal_values(), known), PERIOD, 10.0), Plant(rig)
    errors, wanted = [], []
    for tick in range(1000):
        phase = 4.0 * np.pi * PERIOD * tick
        target = Target(0.01 * np.cos(phase), -0.04 * np.pi * np.sin(phase))
        plant.advance(controller.voltage(Measurement(target.position, target.velocity, 0.0), target), 10)
        if tick >= 500:
            wanted.append(-0.04 * np.pi * np.sin(phase + 4.0 * np.pi * PERIOD))
            errors.append(plant.state.velocity - wanted[-1])
    return float(np.std(errors) / np.std(wanted)) + abs(float(np.mean(errors))) / float(np.std(wanted))


@pytest.mark.parametrize("effect", EFFECTS)
def test_what_is_known_of_the_actuator_is_compensated(effect: str) -> None:
    rig = EFFECTS[effect]
    assert velocity_error(rig, rig) < 0.2 * velocity_error(rig, {})
