"""The position loop's gains against the simulator: the loop settles, and no faster one is thrown away for nothing."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.control.position_gains import LARGEST_SENSITIVITY, PositionGains, position_gains
from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant

PERIOD = 0.002
RIGS = {
    "nominal": {},
    "late": {"command_delay.delay": 0.02},
    "heavy": {"moving_mass": 500.0},
    "soft": {"bulk_modulus": 2e8, "moving_mass": 200.0},
}


def step_response(gains: PositionGains, rig: dict[str, float]) -> np.ndarray:
    """Positions over 2 s after a step of 1 mm of the reference, in steps of PERIOD [mm]."""
    plant, integral, positions = Plant(rig), 0.0, []
    for _ in range(1000):
        error = 1e-3 - plant.state.position
        integral += error * PERIOD
        plant.advance(gains.proportional * error + gains.integral * integral, 20)
        positions.append(1e3 * plant.state.position)
    return np.array(positions)


@pytest.mark.parametrize("rig", RIGS)
def test_a_step_settles_with_bounded_overshoot(rig: str) -> None:
    gains = position_gains(changed(nominal_values(), RIGS[rig]), PERIOD)
    found = step_response(gains, RIGS[rig])
    assert found.max() < 1.6 and np.abs(found[-100:] - 1.0).max() < 0.02
    assert gains.sensitivity <= LARGEST_SENSITIVITY


def test_a_plant_that_allows_it_gets_the_pid_s_crossover() -> None:
    gains = position_gains(nominal_values(), PERIOD)
    assert gains.crossover == pytest.approx(60.0)
    # the gain of a volt: current, orifice root of half the supply pressure, area
    volts = 645e-6 / (2.38e-5 * np.sqrt(2.1e7 / 2) / 100.0)
    assert gains.feedforward == pytest.approx(volts, rel=1e-3)
    assert gains.proportional == pytest.approx(60.0 * volts, rel=1e-3)
    assert gains.integral == pytest.approx(10.0 * gains.proportional)


def test_with_the_pid_s_crossover_the_late_rig_would_not_settle() -> None:
    found = step_response(position_gains(nominal_values(), PERIOD), RIGS["late"])
    assert np.abs(found[-100:] - 1.0).max() > 0.1
