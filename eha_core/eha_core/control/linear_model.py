"""The plant's linearisation as controllers want it: at rest in mid stroke, one pressure difference, sampled."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from eha_core.parameters import NOMINAL
from eha_core.plant import LinearPlant, State, linearise

Array = NDArray[np.float64]

STATES = ("position", "velocity", "load_pressure", "spool_position", "spool_velocity", "current")
"""[m], [m/s], P1 - P2 [Pa], and the valve's three in ampere-equivalents: [A], [A/s], [A]."""


def velocity_gain(parameters: Mapping[str, float]) -> float:
    """Steady velocity per volt without load [(m/s)/V]: the mean of both chambers' no-load flow over their area."""
    a = _at_rest(parameters).A
    spool, velocity = State._fields.index("spool_position"), State._fields.index("velocity")
    chambers = a[[State._fields.index("pressure_a"), State._fields.index("pressure_b")]]
    return -float(np.mean(chambers[:, spool] / chambers[:, velocity])) / parameters["coil_resistance"]


def reduced(parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Return A [6, 6] and B [6] of x' = A x + B u, u in volts, states as in STATES.

    `plant.linearise` with the chambers' mean pressure held: in a symmetric cylinder no voltage moves it, and no sensor
    of motion or force sees it. Effects are left out.
    """
    plant = _at_rest(parameters)
    gather, spread = np.zeros((len(STATES), len(State._fields))), np.zeros((len(State._fields), len(STATES)))
    for row, name in enumerate(STATES):
        of_name = {"pressure_a": 1.0, "pressure_b": -1.0} if name == "load_pressure" else {name: 1.0}
        for field, sign in of_name.items():
            column = State._fields.index(field)
            gather[row, column] = sign
            spread[column, row] = sign / len(of_name)
    return gather @ plant.A @ spread, gather @ plant.B[:, 0]


def discretise(a: Array, b: Array, period: float) -> tuple[Array, Array]:
    """Return the model over one period with the input held: x[k+1] = F x[k] + G u[k]."""
    size = len(b)
    block = np.zeros((size + 1, size + 1))
    block[:size, :size], block[:size, size] = a, b
    over = expm(block * period)
    return over[:size, :size], over[:size, size]


def _at_rest(parameters: Mapping[str, float]) -> LinearPlant:
    """The nominal plant about mid stroke, whatever effects the parameters switch on."""
    return linearise({row.name: parameters[row.name] for row in NOMINAL})
