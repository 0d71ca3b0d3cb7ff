"""What the tests of the export share: a plant with five effects, and a voltage that moves it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eha_core.plant import PAPER, Plant

Array = NDArray[np.float64]

FIVE = {
    "coulomb_friction.force": 250.0, "valve_deadband.half_width": 1e-4, "supply_pressure_droop.resistance": 3e10,
    "position_sensor_lag.time_constant": 0.005, "thermal_drift.damping_ratio": 0.4, "moving_mass": 11.0,
}  # fmt: skip
"""Five effects, two of which remember and one of which depends on time; and a parameter of the plant."""

STEPS = 10
"""Of the plant, in a communication step."""


def values() -> dict[str, float]:
    """Every parameter of the plant with five effects."""
    return {**PAPER.nominal_values(), **FIVE}


def voltages(seconds: float) -> Array:
    """One for each communication step of 1 ms [V]."""
    time = 1e-3 * np.arange(round(1000.0 * seconds))
    voltage: Array = 0.05 * np.sin(2.0 * np.pi * 0.7 * time) + 0.02 * np.sin(2.0 * np.pi * 7.3 * time)
    return voltage


def advanced(plant: Plant, commands: Array, steps: int = STEPS) -> Array:
    """What the plant reports before the first communication step and after each: (n + 1, columns)."""
    rows = [plant.state]
    for command in commands:
        plant.advance(float(command), steps)
        rows.append(plant.state)
    return np.array(rows)
