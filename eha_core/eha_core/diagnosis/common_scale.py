"""Whether one common factor, such as a wrong clock, explains why several parameters differ from their nominal values.

The plant's equations keep their form if time, the position or both pressures are measured in another unit, or if the
piston has another area: each parameter is then scaled by a power of the factor that follows from its unit. The piston's
area and the lines' volume are held in every fit; the powers below allow for that. So a wrong clock changes many values
and is reported as one error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2

from eha_core.diagnosis.criteria import COMMON_FACTOR, NOTICEABLE, RELEVANT, SCALED_ALIKE
from eha_core.diagnosis.result import CommonScale, FittedParameter
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array

CLOCK, POSITION, PRESSURES, AREA = "clock", "position", "pressures", "piston_area"

POWERS: Mapping[str, Mapping[str, float]] = {
    CLOCK: {
        "coil_inductance": 1.0, "valve_natural_frequency": -1.0, "valve_gain": -1.0, "internal_leakage": -1.0,
        "moving_mass": 2.0, "damping_coefficient": 1.0,
    },
    POSITION: {
        "valve_gain": 1.0, "internal_leakage": 1.0, "actuator_displacement": 1.0, "moving_mass": -1.0,
        "damping_coefficient": -1.0, "spring_stiffness": -1.0,
    },
    PRESSURES: {
        "valve_gain": -0.5, "internal_leakage": -1.0, "bulk_modulus": 1.0, "supply_pressure": 1.0, "moving_mass": 1.0,
        "damping_coefficient": 1.0, "spring_stiffness": 1.0,
    },
    AREA: {
        "valve_gain": -1.0, "internal_leakage": -1.0, "moving_mass": -1.0, "damping_coefficient": -1.0,
        "spring_stiffness": -1.0,
    },
}  # fmt: skip
"""The exponent of the factor in each parameter; the factor is recorded seconds, metres or pascals over true ones, or
the true piston area over the nominal one. From the equations: A_p (P1 - P2) = M_p x'' + B_s x' + K_s x, Q = K I
(P_s - P1)^(1/2), P1' V / beta = Q - A_p x' - K_Lin (P1 - P2), L_c I' = V - R_c I, V = A_p (x_s + x)."""

CLOSE = RELEVANT
"""Relative deviation allowed of each parameter: the volumes that are held do not scale with the factor."""


def common_scale(final: Fit, changed: Sequence[FittedParameter]) -> CommonScale | None:
    """The one factor that explains every change, the best of POWERS; None where there is none."""
    names = [parameter.name for parameter in changed if parameter.changed]
    if len(names) < SCALED_ALIKE:
        return None
    places = [
        place
        for place, parameter in enumerate(final.free)
        if parameter.logarithmic
        and "." not in parameter.name
        and not parameter.is_bound_by(final.values[parameter.name])
    ]
    moved = final.q[places]
    spread = final.covariance[np.ix_(places, places)] + CLOSE**2 * np.eye(len(places))
    best: tuple[float, CommonScale] | None = None
    for of, powers in POWERS.items():
        if not set(names) <= set(powers):
            continue
        direction = np.array([powers.get(final.free[place].name, 0.0) for place in places])
        factor, deviation, left = _along(moved, direction, spread)
        if left > float(chi2.ppf(COMMON_FACTOR, max(1, len(places) - 1))) or abs(factor) < NOTICEABLE * deviation:
            continue
        times = float(np.exp(factor))
        if best is None or left < best[0]:
            best = left, CommonScale(of, times, times * deviation, tuple(names))
    return best[1] if best else None


def _along(moved: Array, direction: Array, spread: Array) -> tuple[float, float, float]:
    """The factor's logarithm along a direction, its standard deviation, and the chi^2 that it does not explain."""
    weighted = np.linalg.solve(spread, direction)
    deviation = 1.0 / np.sqrt(max(float(direction @ weighted), 1e-300))
    factor = float(moved @ weighted) * deviation**2
    rest = moved - factor * direction
    return factor, float(deviation), float(rest @ np.linalg.solve(spread, rest))
