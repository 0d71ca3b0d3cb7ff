"""The limits of a rig in a test: position, speed, pressure, energy and voltage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import inf

import numpy as np

from eha_core.identification.numbers import Array
from eha_core.plant import COLUMNS

STROKE_SHARE = 0.85
"""Share of the stroke that a test may use."""

PRESSURE_SHARE = 1.2
"""Share of the supply pressure that a chamber may reach in a test; none may fall to a vacuum."""


@dataclass(frozen=True)
class Limits:
    """The largest values that a test may reach; inf where there is no limit.

    `position`: distance from mid stroke [m, of a vane rad]. `speed`: [m/s, rad/s]. `pressure`: of a chamber, gauge
    [Pa]; none may fall to a vacuum either. `energy`: that the supply gives in the test [J]. `voltage`: of the command
    [V].
    """

    position: float = inf
    speed: float = inf
    pressure: float = inf
    energy: float = inf
    voltage: float = inf

    def shares(self, rows: Array, step: float, atmosphere: float) -> dict[str, float]:
        """The share of each limit, and of the approach to a vacuum, that a motion reaches; above 1 it is exceeded.

        Args:
            rows: (samples, columns) of the plant, all COLUMNS.
            step: between two of them [s].
            atmosphere: its absolute pressure [Pa].
        """
        if not np.all(np.isfinite(rows)):
            return dict.fromkeys(REACHED, inf)
        reached = extremes(rows, step)
        vacuum = -float(np.min(_columns(rows, "pressure_a", "pressure_b"))) / atmosphere
        return {**{name: value / getattr(self, name) for name, value in reached.items()}, "vacuum": max(vacuum, 0.0)}


REACHED = tuple(field.name for field in fields(Limits))
"""The names of the limits."""


def limits_of(values: Mapping[str, float]) -> Limits:
    """The default limits of a rig with these values: a share of stroke and pressure, and the voltage at which the coil
    saturates."""
    return Limits(
        position=STROKE_SHARE * values["actuator_displacement"],
        pressure=PRESSURE_SHARE * values["supply_pressure"],
        voltage=values["saturation_current"] * values["coil_resistance"],
    )


def extremes(rows: Array, step: float) -> dict[str, float]:
    """The extreme of each limited quantity in a motion, by the limits' names [SI]."""
    flow_a, flow_b, supply = _columns(rows, "flow_a", "flow_b", "supply_pressure").T
    # oil enters a chamber from the supply, and leaves it to the return
    power = supply * (np.maximum(flow_a, 0.0) + np.maximum(-flow_b, 0.0))
    return {
        "position": float(np.max(np.abs(_columns(rows, "position")))),
        "speed": float(np.max(np.abs(_columns(rows, "velocity")))),
        "pressure": float(np.max(_columns(rows, "pressure_a", "pressure_b"))),
        "energy": float(np.sum(power) * step),
        "voltage": float(np.max(np.abs(_columns(rows, "voltage")))),
    }


def _columns(rows: Array, *names: str) -> Array:
    return rows[:, [COLUMNS.index(name) for name in names]]
