"""The whole nominal plant against SciPy's Radau at 1e-10 on a right-hand side of its own."""

from __future__ import annotations

import numpy as np
import pytest
from reference_model import POSITION, PRESSURE_A, PRESSURE_B, SPOOL, VELOCITY, solve

from eha_core.plant import Plant, Trajectory

PIECE = 2e-3
"""s; the command is constant over each piece, so that both sides see the same voltage."""


def command(amplitude: float, frequency: float, duration: float) -> np.ndarray:
    """A sine in steps, one value a piece."""
    return amplitude * np.sin(2.0 * np.pi * frequency * (np.arange(round(duration / PIECE)) + 0.5) * PIECE)


def simulate(pieces: np.ndarray, step_size: float, parameters: dict[str, float] | None = None) -> Trajectory:
    """The plant under those pieces, one row a piece."""
    every = round(PIECE / step_size)
    return Plant(parameters, step_size).run(np.repeat(pieces, every), every)


@pytest.mark.parametrize(
    ("amplitude", "frequency", "duration", "metres", "pascals"),
    [(8.4e-3, 1.0, 0.2, 2e-10, 1.0), (0.3, 5.0, 0.2, 4e-8, 100.0), (1.5, 10.0, 0.1, 8e-7, 2e3)],
    ids=["the paper's sine", "a tenth of full command", "most of full command"],
)
def test_states_agree(amplitude: float, frequency: float, duration: float, metres: float, pascals: float) -> None:
    pieces = command(amplitude, frequency, duration)
    expected = solve(pieces, PIECE, 1)
    found = simulate(pieces, 1e-4)
    assert np.max(np.abs(found.position - expected[:, POSITION])) < metres
    assert np.max(np.abs(found.pressure_a - expected[:, PRESSURE_A])) < pascals
    assert np.max(np.abs(found.pressure_b - expected[:, PRESSURE_B])) < pascals
    assert np.max(np.abs(found.spool_position - expected[:, SPOOL])) < 1e-13 * amplitude


def test_a_loaded_leaking_actuator_agrees() -> None:
    theirs = {"Ks": 2e5, "leak": 3e-11, "outside": 1e-11, "Pr": 5e5, "M": 60.0, "beta": 7e8}
    ours = {
        "spring_stiffness": 2e5, "internal_leakage": 3e-11, "external_leakage": 1e-11, "return_pressure": 5e5,
        "moving_mass": 60.0, "bulk_modulus": 7e8,
    }  # fmt: skip
    pieces = command(0.3, 5.0, 0.2)
    expected, found = solve(pieces, PIECE, 1, theirs), simulate(pieces, 1e-4, ours)
    assert np.max(np.abs(found.position - expected[:, POSITION])) < 2e-7
    assert np.max(np.abs(found.pressure_b - expected[:, PRESSURE_B])) < 2e3


def test_the_step_is_of_second_order() -> None:
    pieces = command(0.3, 5.0, 0.1)
    expected = solve(pieces, PIECE, 1)
    errors = []
    for step_size in (2e-4, 1e-4, 5e-5, 2.5e-5):
        found = simulate(pieces, step_size)
        errors.append(np.max(np.abs(found.velocity - expected[:, VELOCITY])))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(orders > 1.8)
    assert orders[-1] == pytest.approx(2.0, abs=0.1)
