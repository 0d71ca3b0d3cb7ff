"""A test bench in closed form: sweeps, a valve's flow, and blocked ports, written apart from the library."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.optimize import brentq

FULL = 20e-3
"""A; the largest current of the sweeps."""


def sweep(steps: int = 41) -> np.ndarray:
    """Currents from null up, down and back to null."""
    up = np.linspace(0.0, FULL, steps)
    return np.concatenate([up, np.linspace(FULL, -FULL, 2 * steps - 1)[1:], -up[::-1][1:]])


def played(currents: np.ndarray, half_width: float) -> np.ndarray:
    """The play operator step by step, having come from the left."""
    at, followed = currents[0] - half_width, []
    for current in currents:
        at = min(current + half_width, max(current - half_width, at))
        followed.append(at)
    return np.array(followed)


def valve_flow(
    currents: np.ndarray, *, gain: float = 2e-2, ratio: float = 0.0, offset: float = 0.0, overlap: float = 0.0,
    half_width: float = 0.0, limit: float = np.inf,
) -> np.ndarray:  # fmt: skip
    """Flow [m^3/s] of a valve whose edges open at +-overlap, both open about null where that is negative."""
    flows = []
    for spool in played(currents, half_width) + offset:
        opened = max(spool - overlap, 0.0) - max(-spool - overlap, 0.0)
        flow = gain * opened * (1.0 if opened > 0.0 else 1.0 - ratio)
        flows.append(min(max(flow, -limit), limit))
    return np.array(flows)


def noisy(values: np.ndarray, share: float, seed: int) -> np.ndarray:
    """Values with noise, a share of the largest."""
    return values + np.random.default_rng(seed).normal(0.0, share * np.max(np.abs(values)), values.size)


def blocked_ports(current: float, gain: float, conductance: float, width: float, supply: float) -> tuple[float, float]:
    """Load pressure [Pa] and the supply's flow [m^3/s] where no oil leaves the ports of a valve with worn lands."""
    lands = conductance * np.exp(-abs(current) / width)

    def into(pressure: float, opening: float) -> float:
        source = supply - pressure if opening > 0.0 else pressure
        return gain * opening * np.sqrt(max(source, 0.0)) + lands * (supply - 2.0 * pressure)

    pressure_a, pressure_b = (
        float(brentq(into, 0.0, supply, args=(side * current,), xtol=1e-6)) for side in (1.0, -1.0)
    )
    high = max(pressure_a, pressure_b)
    drawn = gain * abs(current) * np.sqrt(max(supply - high, 0.0)) + lands * (2.0 * supply - pressure_a - pressure_b)
    return pressure_a - pressure_b, float(drawn)


def table(current: np.ndarray, **columns: np.ndarray) -> Mapping[str, np.ndarray]:
    """Columns as a bench prints them: mA, l/min and bar."""
    units = {
        "Q": (6e4, "l/min"),
        "leakage": (6e4, "l/min"),
        "pA": (1e-5, "bar"),
        "pB": (1e-5, "bar"),
        "pL": (1e-5, "bar"),
    }
    made = {"I [mA]": 1e3 * current}
    for name, values in columns.items():
        factor, unit = units[name]
        made[f"{name} [{unit}]"] = factor * values
    return made
