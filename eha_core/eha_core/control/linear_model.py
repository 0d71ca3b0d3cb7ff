"""The actuator linearised at rest in the middle of its stroke."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Array = NDArray[np.float64]

STATES = ("position", "velocity", "load_pressure", "spool_position", "spool_velocity", "current")
"""[m], [m/s], P1 - P2 [Pa], and the valve's three in ampere-equivalents: [A], [A/s], [A]."""


def velocity_gain(parameters: Mapping[str, float]) -> float:
    """Steady velocity per volt without load [(m/s)/V]: the valve's no-load flow over the piston's area."""
    return _flow_gain(parameters) / (parameters["coil_resistance"] * _area(parameters))


def linearise(parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Return A [6, 6] and B [6] of x' = A x + B u, u in volts, states as in STATES.

    The model's equations (1) to (10) at zero opening and equal chamber pressures; coil and spool far from their
    limits. The cylinder is taken as symmetric, with the mean of its areas.
    """
    get = parameters.__getitem__
    area, mass = _area(parameters), get("moving_mass")
    volume = area * get("actuator_displacement") + get("line_volume")
    stiffness = get("bulk_modulus") / volume  # of one chamber, Pa/m^3
    frequency, damping = get("valve_natural_frequency"), get("valve_damping_ratio")
    a = np.zeros((6, 6))
    a[0, 1] = 1.0
    a[1, :3] = -get("spring_stiffness") / mass, -get("damping_coefficient") / mass, area / mass
    leak = 2.0 * get("internal_leakage") + get("external_leakage")
    a[2, 1:4] = -2.0 * stiffness * area, -stiffness * leak, 2.0 * stiffness * _flow_gain(parameters)
    a[3, 4] = 1.0
    a[4, 3:] = -(frequency**2), -2.0 * damping * frequency, frequency**2
    a[5, 5] = -get("coil_resistance") / get("coil_inductance")
    b = np.zeros(6)
    b[5] = 1.0 / get("coil_inductance")
    return a, b


def discretise(a: Array, b: Array, period: float) -> tuple[Array, Array]:
    """Return the model over one period with the input held: x[k+1] = F x[k] + G u[k]."""
    size = len(b)
    block = np.zeros((size + 1, size + 1))
    block[:size, :size], block[:size, size] = a, b
    over = expm(block * period)
    return over[:size, :size], over[:size, size]


def _area(parameters: Mapping[str, float]) -> float:
    return 0.5 * (parameters["piston_area"] + parameters["piston_area_b"])


def _flow_gain(parameters: Mapping[str, float]) -> float:
    """No-load flow per ampere-equivalent of spool position [m^3/(s A)]."""
    drop = 0.5 * (parameters["supply_pressure"] - parameters["return_pressure"])
    return parameters["valve_gain"] * sqrt(drop)
