"""The truth against SciPy's Radau on the paper's equations, written out here once more."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eha_exam.truth import simulate_truth

RATE = 1000.0
COMMAND = 0.06 * np.sin(2.0 * np.pi * 1.5 * np.arange(401) / RATE) + 0.02


def signed_root(drop: float) -> float:
    return float(np.sign(drop) * np.sqrt(abs(drop)))


def paper(time: float, y: np.ndarray, voltage: float, friction: float) -> list[float]:
    """Equations (1) to (10) with Table 1; friction is that of a slip in one direction."""
    current, spool, spool_rate, x, v, p1, p2 = y
    if spool >= 0.0:
        q1, q2 = 2.38e-5 * spool * signed_root(2.1e7 - p1), 2.38e-5 * spool * signed_root(p2)
    else:
        q1, q2 = 2.38e-5 * spool * signed_root(p1), 2.38e-5 * spool * signed_root(2.1e7 - p2)
    leak = 1e-12 * (p1 - p2)
    return [
        (voltage - 100.0 * current) / 0.59,
        spool_rate,
        543.0**2 * (current - spool) - 2.0 * 0.48 * 543.0 * spool_rate,
        v,
        (645e-6 * (p1 - p2) - 2000.0 * v - 10.0 * x - friction * np.sign(v)) / 9.0,
        1.4e9 / (1e-5 + 645e-6 * (0.1 + x)) * (q1 - leak - 645e-6 * v),
        1.4e9 / (1e-5 + 645e-6 * (0.1 - x)) * (645e-6 * v - q2 + leak),
    ]


def radau(friction: float) -> np.ndarray:
    """States at every sample, integrated over each hold of the command apart."""
    y = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.05e7, 1.05e7])
    rows = [y]
    scale = np.array([1e-9, 1e-9, 1e-6, 1e-12, 1e-10, 0.1, 0.1])
    for k in range(len(COMMAND) - 1):
        span = (k / RATE, (k + 1) / RATE)
        y = solve_ivp(paper, span, y, "Radau", rtol=1e-9, atol=scale, args=(COMMAND[k], friction)).y[:, -1]
        rows.append(y)
    return np.array(rows)


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    return radau(0.0)


@pytest.mark.parametrize(
    ("column", "state", "tolerance"),
    [("current", 0, 1e-11), ("spool", 1, 1e-10), ("position", 3, 3e-8), ("velocity", 4, 1e-6), ("pressure_a", 5, 30.0)],
)
def test_the_nominal_actuator_agrees_with_radau(
    reference: np.ndarray, column: str, state: int, tolerance: float
) -> None:
    truth = simulate_truth({"transition_pressure": 1.0}, [], COMMAND, 0.4)
    np.testing.assert_allclose(truth[column], reference[:, state], rtol=0.0, atol=tolerance)
