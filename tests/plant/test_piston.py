"""Equation (10) and the whole loop against force balances and the small-signal closed form."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import Plant

STEP = 1e-4


def sine(amplitude: float, frequency: float, duration: float, step_size: float = STEP) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * frequency * step_size * np.arange(round(duration / step_size)))


def test_forces_balance_the_acceleration() -> None:
    step_size = 1e-5
    found = Plant({"spring_stiffness": 1e5}, step_size).run(sine(0.2, 5.0, 0.2, step_size))
    acceleration = np.gradient(found.velocity, found.time)
    force = 645e-6 * (found.pressure_a - found.pressure_b) - 2000.0 * found.velocity - 1e5 * found.position
    assert force[9:-9] == pytest.approx(9.0 * acceleration[9:-9], abs=2e-3 * np.max(9.0 * np.abs(acceleration)))
    # the step weighs its forces at its middle, half a step before the row
    hydraulic = 645e-6 * (found.pressure_a - found.pressure_b)
    middle = 0.5 * (hydraulic[1:] + hydraulic[:-1])
    assert found.hydraulic_force[1:] == pytest.approx(middle, abs=1e-3 * np.max(np.abs(hydraulic)))


def test_the_nominal_piston_has_no_friction() -> None:
    found = Plant(step_size=1e-5).run(sine(0.2, 5.0, 0.2, 1e-5))
    assert np.max(np.abs(found.friction_force)) < 1e-4 * np.max(np.abs(found.hydraulic_force))


def test_friction_force_is_the_dry_friction_while_sliding() -> None:
    found = Plant({"coulomb_friction.force": 150.0}, 1e-5).run(sine(0.2, 5.0, 0.2, 1e-5))
    sliding = np.abs(found.velocity) > 0.02
    assert found.friction_force[sliding] == pytest.approx(150.0 * np.sign(found.velocity[sliding]), rel=1e-2)


def test_sine_shrinks_by_leakage_as_the_small_signal_model_says() -> None:
    def amplitude(leakage: float) -> float:
        found = Plant({"internal_leakage": leakage, "spring_stiffness": 0.0}, STEP).run(sine(8.4e-3, 1.0, 3.0))
        last = found.time > 2.0
        return float(np.ptp(found.position[last]))

    without = amplitude(0.0)
    for leakage in (1e-12, 1e-11, 1e-10):
        k = leakage * 2000.0 / 645e-6**2
        assert amplitude(leakage) / without == pytest.approx(1.0 / (1.0 + k), rel=2e-3)


def test_steady_speed_is_flow_over_area() -> None:
    free = {"internal_leakage": 0.0, "damping_coefficient": 0.0, "spring_stiffness": 0.0}
    rows = Plant(free, initial_position=-0.09).run(np.full(3000, 0.05))
    expected = 2.38e-5 * 5e-4 * np.sqrt(1.05e7) / 645e-6
    assert rows.velocity[-1] == pytest.approx(expected, rel=1e-6)


def test_piston_sticks_exactly_until_the_load_breaks_it_away() -> None:
    plant = Plant({"coulomb_friction.force": 200.0, "constant_load.force": 150.0, "spring_stiffness": 0.0})
    held = plant.run(np.zeros(2000))
    assert np.all(held.velocity == 0.0)
    assert np.all(held.position == 0.0)
    assert held.friction_force == pytest.approx(0.0, abs=1e-9)  # the seals bear the load, and the two cancel
    plant.set_parameters({"constant_load.force": 250.0})
    assert plant.run(np.zeros(50)).position[-1] < 0.0


def test_sticking_piston_rests_at_each_turn_of_the_command() -> None:
    found = Plant({"coulomb_friction.force": 400.0}).run(sine(0.02, 1.0, 2.0))
    rest = found.velocity == 0.0
    assert 0.01 < np.mean(rest) < 0.5
    moving = ~rest
    assert np.all(np.abs(found.hydraulic_force[rest] - 10.0 * found.position[rest]) <= 400.0 * (1.0 + 1e-9))
    assert np.any(found.velocity[moving] > 0.0)
    assert np.any(found.velocity[moving] < 0.0)


def test_an_undamped_piston_on_a_spring_keeps_its_energy_and_its_pitch() -> None:
    # shut valve, oil as two springs: x'' = -(2 beta A^2 / V) x / M, set off by a load that is then taken away
    free = {"internal_leakage": 0.0, "damping_coefficient": 0.0, "spring_stiffness": 0.0}
    plant = Plant(free | {"constant_load.force": 10.0}, 2e-5)
    plant.run(np.zeros(1000))
    plant.set_parameters({"constant_load.force": 0.0})
    found = plant.run(np.zeros(25000))
    stiffness = 2.0 * 1.4e9 * 645e-6**2 / (1e-5 + 645e-6 * 0.1)
    centred = found.position - np.mean(found.position)
    crossings = np.flatnonzero((centred[:-1] < 0.0) & (centred[1:] >= 0.0))
    share = centred[crossings] / (centred[crossings] - centred[crossings + 1])
    period = np.mean(np.diff(found.time[crossings] + share * 2e-5))
    assert 2.0 * np.pi / period == pytest.approx(np.sqrt(stiffness / 9.0), rel=1e-4)
    early, late = np.ptp(found.position[:2000]), np.ptp(found.position[-2000:])
    assert late == pytest.approx(early, rel=1e-2)
