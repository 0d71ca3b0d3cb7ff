"""The time derivative of the equations, against SciPy, a second writing of them, and the pieces of the step."""

from __future__ import annotations

import numpy as np
import pytest
import reference_model
from scipy.integrate import solve_ivp

from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, Plant, State, derivatives
from eha_core.plant.scheme import coil_current, oil_step, port_flows, velocity_step

REST = State(0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7)
LOADED = {
    "spring_stiffness": 2e5, "internal_leakage": 3e-11, "external_leakage": 1e-11, "return_pressure": 5e5,
    "moving_mass": 60.0, "bulk_modulus": 7e8,
}  # fmt: skip


@pytest.mark.parametrize(("parameters", "metres", "pascals"), [({}, 2e-9, 3.0), (LOADED, 2e-9, 3.0)])
def test_scipy_over_the_derivative_agrees_with_the_plant(
    parameters: dict[str, float], metres: float, pascals: float
) -> None:
    step, count, every = 2e-5, 5000, 500

    def voltage(time: float) -> float:
        return 0.1 * np.sin(2.0 * np.pi * 5.0 * time)

    plant = Plant(parameters, step)
    start = [getattr(plant.state, name) for name in State._fields]
    found = plant.run(voltage((np.arange(count) + 0.5) * step), every)
    expected = solve_ivp(
        lambda time, state: derivatives(state, voltage(time), parameters), (0.0, count * step), start, method="LSODA",
        t_eval=found.time, rtol=1e-9, atol=[1e-12, 1e-12, 1e-9, 1e-11, 1e-9, 1e-2, 1e-2],
    )  # fmt: skip
    assert expected.success
    state = State(*expected.y)
    assert np.max(np.abs(state.position)) > 1e-3
    assert np.max(np.abs(found.position - state.position)) < metres
    assert np.max(np.abs(found.pressure_a - state.pressure_a)) < pascals
    assert np.max(np.abs(found.pressure_b - state.pressure_b)) < pascals
    assert np.max(np.abs(found.spool_position - state.spool_position)) < 1e-9


def test_a_second_writing_of_the_equations_agrees() -> None:
    generator = np.random.default_rng(4)
    for _ in range(50):
        state = State(*generator.uniform(-1, 1, 5) * [0.02, 0.02, 5.0, 0.09, 1.0], *generator.uniform(1e6, 2e7, 2))
        expected = reference_model.derivatives(0.0, state, lambda _: 0.3, reference_model.TABLE_1)
        assert derivatives(state, 0.3) == pytest.approx(tuple(expected), rel=1e-12, abs=1e-9)


def test_the_current_saturates() -> None:
    full = REST._replace(current=0.02)
    assert derivatives(full, 5.0).current == 0.0
    assert derivatives(full._replace(current=-0.02), -5.0).current == 0.0
    assert derivatives(full, 1.0).current == pytest.approx((1.0 - 2.0) / 0.59)
    assert derivatives(full._replace(current=0.0199), 5.0).current > 0.0


def test_a_step_tends_to_the_derivative() -> None:
    """What the step solves in forms of its own: the coil, the oil's stiffness, the implicit piston."""
    tau, state = 1e-9, State(0.01, 0.012, 0.0, 0.03, 0.2, 1.3e7, 8e6)
    rate = derivatives(state, 0.5)
    current = coil_current(state.current, 0.5, np.exp(-tau * 100.0 / 0.59), 0.01, 0.02)
    assert (current - state.current) / tau == pytest.approx(rate.current, rel=1e-5)
    pressures = state.pressure_a, state.pressure_b
    ports = port_flows(state.spool_position, 2.38e-5, 0.0, *pressures, 2.1e7, 0.0)
    chambers = 645e-6, 1.4e9, 0.0, 1.4e9, 0.0, 1e-12 * (pressures[0] - pressures[1]), 1e-12, 0.0, 0.0
    after_a, after_b, _ = oil_step(
        tau, ports, chambers, state.position, state.velocity, *pressures, 645e-6, 0.1, 1e-5, 101325.0
    )
    assert (after_a - pressures[0]) / tau == pytest.approx(rate.pressure_a, rel=1e-5)
    assert (after_b - pressures[1]) / tau == pytest.approx(rate.pressure_b, rel=1e-5)
    driving = 645e-6 * (pressures[0] - pressures[1]) - 10.0 * state.position
    velocity = velocity_step(tau, state.position, state.velocity, driving, (0.0, 2000.0, 0.0, 0.0), 1e7, 9.0, 10.0, 0.1)
    assert (velocity - state.velocity) / tau == pytest.approx(rate.velocity, rel=1e-5)


def test_fields_stand_as_in_a_row() -> None:
    first = COLUMNS.index("current")
    assert COLUMNS[first : first + 7] == State._fields


@pytest.mark.parametrize(
    ("state", "parameters", "refusal"),
    [
        (REST._replace(position=0.11), {}, "0.11 m is outside the stroke"),
        (REST._replace(position=float("nan")), {}, "nan m is outside the stroke"),
        (REST, {"coulomb_friction.force": 250.0}, "coulomb_friction is switched on"),
        (REST, {"moving_mas": 9.0}, "did you mean moving_mass"),
    ],
)
def test_refuses(state: State, parameters: dict[str, float], refusal: str) -> None:
    with pytest.raises(ParameterError, match=refusal):
        derivatives(state, 0.0, parameters)
