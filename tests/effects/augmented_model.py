"""The actuator with its effects as one right-hand side for SciPy, apart from the library: plain laws, no ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

CURRENT, SPOOL, RATE, POSITION, VELOCITY, PRESSURE_A, PRESSURE_B, LOSS, RISE, BRISTLE = range(10)


@dataclass(frozen=True)
class Laws:
    """Sizes of the effects, all absent unless given; SI units. `leak_after` holds from `onset` on."""

    offset: float = 0.0
    overlap: float = 0.0
    rounding: float = 0.0
    asymmetry: float = 0.0
    saturation: float = 0.0
    null_conductance: float = 0.0
    null_width: float = 1.0
    droop: float = 0.0
    back: float = 0.0
    line_time: float = 1.0
    turbulent: float = 0.0
    worn: tuple[float, float, float] = (0.0, 0.0, 1.0)
    outside_a: float = 0.0
    outside_b: float = 0.0
    air: float = 0.0
    area_ratio: float = 1.0
    quadratic: float = 0.0
    one_way: float = 0.0
    load: float = 0.0
    cubic: float = 0.0
    stop: tuple[float, float, float, float] = (-1.0, 1.0, 0.0, 0.0)
    bristle: tuple[float, float, float, float, float] | None = None
    leak_after: float = 1e-12
    onset: float = 0.0
    damping_lost: float = 0.0
    leak_gained: float = 0.0
    warming: float = 1.0


def root(pressure: float) -> float:
    return float(np.sign(pressure) * np.sqrt(abs(pressure)))


def compliance(gauge: float, air: float) -> float:
    """1 / bulk modulus: volume-weighted compliances of oil and of air that follows P V^1.4 = constant from 1 atm."""
    absolute = gauge + 101325.0
    bubbles = air * (101325.0 / absolute) ** (1.0 / 1.4)
    share = bubbles / (bubbles + 1.0 - air)
    return (1.0 - share) / 1.4e9 + share / (1.4 * absolute)


def _past_edge(overlap: float, rounding: float) -> float:
    within = np.clip(overlap, -rounding, rounding) + rounding
    return float(max(overlap - rounding, 0.0) + (within * within / (4.0 * rounding) if rounding else 0.0))


def flows(spool: float, a: float, b: float, supply: float, back: float, laws: Laws) -> tuple[float, float]:
    """Into port A and out of port B."""
    opening = spool + laws.offset
    opening = _past_edge(opening - laws.overlap, laws.rounding) - _past_edge(-opening - laws.overlap, laws.rounding)
    opening /= 1.0 + laws.saturation * abs(opening)
    if opening >= 0.0:
        into_a, out_of_b = 2.38e-5 * opening * root(supply - a), 2.38e-5 * opening * root(b - back)
    else:
        gain = 2.38e-5 * (1.0 - laws.asymmetry)
        into_a, out_of_b = gain * opening * root(a - back), gain * opening * root(supply - b)
    seep = laws.null_conductance * np.exp(-abs(spool) / laws.null_width)
    return into_a + seep * (supply - a) - seep * (a - back), out_of_b + seep * (b - back) - seep * (supply - b)


def stop_force(position: float, velocity: float, stop: tuple[float, float, float, float]) -> float:
    lower, upper, stiffness, damping = stop
    if lower <= position <= upper:
        return 0.0
    return -stiffness * (position - (upper if position > upper else lower)) - damping * velocity


def derivatives(time: float, y: np.ndarray, voltage: float, laws: Laws) -> np.ndarray:
    """Equations (1) to (10) with every law in its place."""
    position, velocity, a, b = y[POSITION], y[VELOCITY], y[PRESSURE_A], y[PRESSURE_B]
    into_a, out_of_b = flows(y[SPOOL], a, b, 2.1e7 - y[LOSS], y[RISE], laws)
    drawn, returned = (into_a, out_of_b) if y[SPOOL] >= 0.0 else (-out_of_b, -into_a)
    warmth = 1.0 - np.exp(-time / laws.warming)
    leak = (laws.leak_after if time >= laws.onset else 1e-12) * (1.0 + laws.leak_gained * warmth)
    past = leak * (a - b) + laws.turbulent * (a - b) / ((a - b) ** 2 + 1e6) ** 0.25  # rounded below 1 kPa
    coefficient, centre, width = laws.worn
    past += coefficient * (a - b) / np.cosh((position - centre) / width) ** 2
    area_b = 645e-6 * laws.area_ratio
    force = 645e-6 * a - area_b * b - 2000.0 * (1.0 - laws.damping_lost * warmth) * velocity - 10.0 * position
    force -= 2000.0 * laws.one_way * abs(velocity)
    force += -laws.quadratic * velocity * abs(velocity) - laws.load - laws.cubic * position**3
    force += stop_force(position, velocity, laws.stop)
    bending = 0.0
    if laws.bristle:
        sliding, static, speed, stiffness, damping = laws.bristle
        level = sliding + (static - sliding) * np.exp(-((velocity / speed) ** 2))
        bending = velocity - stiffness * abs(velocity) / level * y[BRISTLE]
        force -= stiffness * y[BRISTLE] + damping * bending
    volume_a, volume_b = 1e-5 + 645e-6 * (0.1 + position), 1e-5 + area_b * (0.1 - position)
    return np.array([
        (voltage - 100.0 * y[CURRENT]) / 0.59,
        y[RATE],
        543.0**2 * (y[CURRENT] - y[SPOOL]) - 2.0 * 0.48 * 543.0 * y[RATE],
        velocity,
        force / 9.0,
        (into_a - past - laws.outside_a * a - 645e-6 * velocity) / (volume_a * compliance(a, laws.air)),
        (area_b * velocity - out_of_b + past - laws.outside_b * b) / (volume_b * compliance(b, laws.air)),
        (laws.droop * drawn - y[LOSS]) / laws.line_time,
        (laws.back * returned - y[RISE]) / laws.line_time,
        bending,
    ])  # fmt: skip


def solve(voltages: np.ndarray, piece: float, laws: Laws) -> np.ndarray:
    """States (pieces, 10) at the end of each piece of constant voltage."""
    state = np.zeros(10)
    state[[PRESSURE_A, PRESSURE_B]] = 1.05e7
    scale = np.array([1e-9, 1e-9, 1e-6, 1e-10, 1e-8, 1.0, 1.0, 1.0, 1.0, 1e-12])
    rows = []
    for k, held in enumerate(voltages):
        span = (k * piece, (k + 1) * piece)
        solution = solve_ivp(derivatives, span, state, method="LSODA", rtol=1e-9, atol=1e-2 * scale, args=(held, laws))
        assert solution.success, solution.message
        state = solution.y[:, -1]
        rows.append(state)
    return np.array(rows)
