"""Equations (1) to (10) written a second time, for SciPy: plain roots, no ends, no saturation,
and tolerances far below what is tested.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

CURRENT, SPOOL, SPOOL_RATE, POSITION, VELOCITY, PRESSURE_A, PRESSURE_B = range(7)

TABLE_1 = {
    "R": 100.0, "L": 0.59, "xi": 0.48, "w": 543.0, "K": 2.38e-5, "beta": 1.4e9, "Ps": 2.1e7,
    "Pr": 0.0, "Ks": 10.0, "xs": 0.1, "A": 645e-6, "M": 9.0, "B": 2000.0, "leak": 1e-12, "outside": 0.0, "line": 1e-5,
}  # fmt: skip


def root(pressure: float) -> float:
    """sign(p) sqrt|p|."""
    return float(np.sign(pressure) * np.sqrt(abs(pressure)))


def derivatives(time: float, state: np.ndarray, voltage: Callable[[float], float], p: dict[str, float]) -> list[float]:
    """The paper's right-hand side."""
    current, spool, rate, position, velocity, a, b = state
    if spool >= 0.0:
        into_a, out_of_b = p["K"] * spool * root(p["Ps"] - a), p["K"] * spool * root(b - p["Pr"])
    else:
        into_a, out_of_b = p["K"] * spool * root(a - p["Pr"]), p["K"] * spool * root(p["Ps"] - b)
    past = p["leak"] * (a - b)
    volume_a, volume_b = p["line"] + p["A"] * (p["xs"] + position), p["line"] + p["A"] * (p["xs"] - position)
    return [
        (voltage(time) - p["R"] * current) / p["L"],
        rate,
        p["w"] ** 2 * (current - spool) - 2.0 * p["xi"] * p["w"] * rate,
        velocity,
        (p["A"] * (a - b) - p["B"] * velocity - p["Ks"] * position) / p["M"],
        p["beta"] / volume_a * (into_a - past - p["outside"] * a - p["A"] * velocity),
        p["beta"] / volume_b * (p["A"] * velocity - out_of_b + past - p["outside"] * b),
    ]


def solve(
    voltages: np.ndarray, step_size: float, every: int, changes: dict[str, float] | None = None, position: float = 0.0
) -> np.ndarray:
    """States (rows, 7) after every `every` steps under voltages that are held over each step, from rest."""
    p = TABLE_1 | (changes or {})
    half = 0.5 * (p["Ps"] + p["Pr"])
    state = np.array([0.0, 0.0, 0.0, position, 0.0, half, half])
    rows = []
    for first in range(0, len(voltages), every):
        held = voltages[first : first + every]
        assert np.all(held == held[0]), "the reference takes pieces of constant voltage"
        solution = solve_ivp(
            derivatives, (0.0, every * step_size), state, method="Radau", rtol=1e-10, atol=1e-14,
            args=(lambda _, volts=held[0]: volts, p),
        )  # fmt: skip
        state = solution.y[:, -1]
        rows.append(state)
    return np.array(rows)
