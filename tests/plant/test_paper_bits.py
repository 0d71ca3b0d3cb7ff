"""The paper's actuator to the last bit: one second of it as it was before a plant could be put together otherwise."""

from __future__ import annotations

import hashlib

import numpy as np

from eha_core.parameters import nominal_values
from eha_core.plant import COLUMNS, Plant
from eha_core.plant.composite import compiled_step
from eha_core.plant.packing import pack
from eha_core.plant.ring import LONGEST_DELAY
from eha_core.plant.state import AT, PISTON, Places

STEP = 1e-4
STEPS = 10_000
EVERY = 10
LEVELS = (0.0, 0.0625, -0.125, 0.03125, 0.25, -0.0625, 2.5, -0.5)
"""V, each held for an eighth of the second: exact numbers, so that no library's rounding is in the command."""

COMMAND = np.repeat(LEVELS, STEPS // len(LEVELS))

PROPAGATOR = tuple(
    map(
        float.fromhex,
        (
            "0x1.f765295a5d61cp-1", "0x1.47ae147ae147bp-7", "0x1.ff4220e9049eap-1", "0x1.987c2de86fdc8p-14",
            "0x1.f820b7a498b46p-11", "0x1.feb74891d96bbp-12", "-0x1.cb729201aacb0p+4", "0x1.e543e81be5bdep-1",
            "0x1.c60b3ce2b7be9p+3", "0x1.d0d9e7209ddb2p+3",
        ),
    )
)  # fmt: skip
"""The valve's, written out: its matrix exponential may differ in the last bit from one linear algebra to another."""

ROWS = "a20e2d57b86893acfe88e062c7fa8b0d355998508d75f2354a0698bbdef9f2b1"
"""SHA-256 of every column of the rows, computed on the commit before `eha_core.plant.parts`."""

LAST = ("0x1.40d14a4068ebdp-5", "-0x1.238b7d26e0ef5p-1", "0x1.258092c28a611p+23", "0x1.5b5dfdad9a40ep+23")
"""Position, velocity and both pressures at the end."""


def rows() -> np.ndarray:
    """Every column at 1 kHz; the command saturates the current and runs the piston into an end."""
    vector, active, _ = pack(nominal_values(), STEP)
    state = np.zeros(len(Places._fields))
    state[AT.supply_pressure] = 2.1e7
    state[PISTON] = 0.0, 0.0, 1.05e7, 1.05e7
    history = np.zeros(int(LONGEST_DELAY / STEP) + 3)
    found = np.empty((STEPS // EVERY, len(COLUMNS)))
    compiled_step().advance(state, np.zeros(64), history, vector, active, PROPAGATOR, COMMAND, STEP, EVERY, found)
    return found


def test_one_second_of_the_papers_actuator_is_what_it_was() -> None:
    found = rows()
    assert tuple(value.hex() for value in found[-1, 4:8].tolist()) == LAST
    assert hashlib.sha256(found.tobytes()).hexdigest() == ROWS


def test_the_default_plant_is_the_papers() -> None:
    propagator = pack(nominal_values(), STEP)[2]
    found = Plant().run(COMMAND, EVERY).values
    assert propagator == PROPAGATOR or np.allclose(propagator, PROPAGATOR, rtol=1e-12)
    if propagator == PROPAGATOR:
        assert found.tobytes() == rows().tobytes()
    else:
        assert np.allclose(found, rows(), rtol=1e-6, atol=1e-9)
