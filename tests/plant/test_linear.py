"""The linearisation, against differences of the derivative, closed forms, and the plant under a small command."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import cont2discrete

from eha_core.errors import ParameterError
from eha_core.plant import LinearPlant, Plant, State, derivatives, linearise

STEPS = np.array([1e-6, 1e-6, 1e-3, 1e-6, 1e-5, 100.0, 100.0])
LOADED = {
    "piston_area_b": 500e-6, "spring_stiffness": 2e4, "internal_leakage": 1e-11, "external_leakage": 1e-12,
    "return_pressure": 5e5,
}  # fmt: skip


def differences(plant: LinearPlant, parameters: dict[str, float]) -> np.ndarray:
    """Central differences of the derivative about the operating point, a column a state."""
    point, columns = np.array(plant.operating_point), []
    for index, step in enumerate(STEPS):
        move = step * np.eye(7)[index]
        ahead = np.array(derivatives(point + move, plant.voltage, parameters))
        columns.append((ahead - derivatives(point - move, plant.voltage, parameters)) / (2.0 * step))
    return np.array(columns).T


@pytest.mark.parametrize("parameters", [{}, LOADED], ids=["nominal", "loaded and leaking"])
@pytest.mark.parametrize(("position", "opening"), [(0.0, 0.0), (0.05, 0.0), (0.0, 4e-3), (-0.03, -0.01)])
def test_matches_finite_differences(parameters: dict[str, float], position: float, opening: float) -> None:
    plant = linearise(parameters, position, opening)
    expected = differences(plant, parameters)
    largest = np.max(np.abs(expected * STEPS), axis=1)[:, None] / STEPS  # entries by what a step of their state makes
    assert np.all(np.abs(plant.A - expected) < 1e-5 * np.abs(expected) + 1e-6 * largest)
    ahead = np.array(derivatives(plant.operating_point, plant.voltage + 1e-3, parameters))
    behind = np.array(derivatives(plant.operating_point, plant.voltage - 1e-3, parameters))
    np.testing.assert_allclose(plant.B[:, 0], (ahead - behind) / 2e-3, rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("parameters", [{}, LOADED | {"external_leakage": 0.0}])
def test_an_open_valve_moves_the_piston_steadily(parameters: dict[str, float]) -> None:
    plant = linearise(parameters, 0.02, 5e-3)
    rate = derivatives(plant.operating_point, plant.voltage, parameters)
    assert rate.position == plant.operating_point.velocity > 0.1
    assert abs(rate.velocity) < 1e-6 * 2.1e7 * 645e-6 / 9.0
    assert abs(rate.pressure_a) < 10.0 and abs(rate.pressure_b) < 10.0
    assert rate.current == rate.spool_velocity == 0.0


@pytest.mark.parametrize("damping", [0.0, 500.0])
def test_hydraulic_resonance_has_its_closed_form(damping: float) -> None:
    ideal = {"internal_leakage": 0.0, "spring_stiffness": 0.0, "damping_coefficient": damping}
    poles = np.linalg.eigvals(linearise(ideal).A[3:, 3:])
    pole = poles[np.argmax(poles.imag)]
    volume = 2.0 * (1e-5 + 645e-6 * 0.1)
    natural = np.sqrt(4.0 * 1.4e9 * 645e-6**2 / (volume * 9.0))
    assert abs(pole) == pytest.approx(natural, rel=1e-9)
    assert pole.real == pytest.approx(-0.5 * damping / 9.0, abs=1e-6)


def test_velocity_gain_has_its_closed_form() -> None:
    plant = linearise({"spring_stiffness": 0.0})
    slow = 0.1j
    gain = abs(plant.C @ np.linalg.solve(slow * np.eye(7) - plant.A, plant.B))[plant.outputs.index("velocity"), 0]
    leaking = 1e-12 * 2000.0 / 645e-6**2
    assert gain == pytest.approx(2.38e-5 * np.sqrt(1.05e7) / 645e-6 / 100.0 / (1.0 + leaking), rel=1e-6)


@pytest.mark.parametrize(("parameters", "position"), [({}, 0.0), ({"spring_stiffness": 0.0}, 0.04)])
def test_a_small_command_moves_the_plant_as_it_says(parameters: dict[str, float], position: float) -> None:
    step, count = 5e-5, 4000
    voltages = 2e-5 * np.sin(2.0 * np.pi * (5.0 + 25.0 * step * np.arange(count)) * step * np.arange(count))
    linear = linearise(parameters, position)
    plant = Plant(parameters, step, position)
    found = plant.run(voltages)
    forward, inputs, *_ = cont2discrete((linear.A, linear.B, linear.C, linear.D), step)
    state, rows = np.zeros(7), np.empty((count, 4))
    for index, voltage in enumerate(voltages):
        state = forward @ state + inputs[:, 0] * voltage
        rows[index] = linear.C @ state
    for column, name in enumerate(linear.outputs):
        change = getattr(found, name) - getattr(linear.operating_point, name)
        assert np.max(np.abs(change - rows[:, column])) < 1e-3 * np.max(np.abs(change)), name


def test_names_and_shapes_belong_together() -> None:
    plant = linearise()
    assert plant.states == State._fields and plant.inputs == ("voltage",)
    assert plant.A.shape == (7, 7) and plant.B.shape == (7, 1)
    assert plant.C.shape == (len(plant.outputs), 7) and plant.D.shape == (len(plant.outputs), 1)
    state = State(*np.arange(7.0))
    assert tuple(plant.C @ state) == tuple(getattr(state, name) for name in plant.outputs)


@pytest.mark.parametrize(
    ("parameters", "position", "opening", "refusal"),
    [
        ({}, 0.0, 0.02, "less than the 0.02 A of saturation"),
        ({}, 0.11, 0.0, "outside the stroke"),
        ({"spring_stiffness": 1e6}, 0.09, 0.0, "softer spring"),
        ({"spring_stiffness": 1e6}, 0.09, 1e-3, "smaller opening"),
        ({"coulomb_friction.force": 250.0}, 0.0, 0.0, "switched on"),
    ],
)
def test_refuses(parameters: dict[str, float], position: float, opening: float, refusal: str) -> None:
    with pytest.raises(ParameterError, match=refusal):
        linearise(parameters, position, opening)
