"""The linearisation against the simulator itself, driven so gently that its nonlinearity stays out."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.control.linear_model import discretise, reduced, velocity_gain
from eha_core.parameters import changed, nominal_values
from eha_core.plant import Plant

PERIOD = 1e-3


@pytest.mark.parametrize(
    "changes",
    [{}, {"internal_leakage": 1e-10, "external_leakage": 1e-14, "moving_mass": 25.0}, {"spring_stiffness": 1e6}],
    ids=["nominal", "leaking and heavy", "on a spring"],
)
def test_a_gentle_command_moves_model_and_simulator_alike(changes: dict[str, float]) -> None:
    values = changed(nominal_values(), changes)
    voltage = 1e-3 * np.sin(2 * np.pi * 20 * PERIOD * np.arange(300))
    seen = Plant(changes).run(np.repeat(voltage, 10), every=10)
    over, into = discretise(*reduced(values), PERIOD)
    state, rows = np.zeros(6), []
    for volts in voltage:
        state = over @ state + into * volts
        rows.append(state)
    model = np.array(rows).T
    load = seen.pressure_a - seen.pressure_b
    for simulated, linear in ((seen.velocity, model[1]), (load, model[2]), (seen.current, model[5])):
        measured = simulated[-len(linear) :]
        assert np.sqrt(np.mean((measured - linear) ** 2)) < 0.02 * np.sqrt(np.mean(measured**2))


def test_the_steady_velocity_per_volt_is_the_simulator_s() -> None:
    # some damping, for the oil's resonance to die out; it takes a ten-thousandth of the pressure
    plant = Plant({"internal_leakage": 0.0, "damping_coefficient": 200.0, "spring_stiffness": 0.0})
    plant.advance(0.01, 20_000)
    assert plant.state.velocity == pytest.approx(0.01 * velocity_gain(nominal_values()), rel=1e-3)
