"""The effects' own states where they begin to act."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects

Array = NDArray[np.float64]


def starting_memory(current: float, piston: Array) -> tuple[Array, NDArray[np.int64]]:
    """The effects' states at a valve current [A] and a piston's state (position, velocity, ...), and which of them are
    sensors' that trail the piston."""
    starts = {"zero": 0.0, "current": current, "position": piston[0], "velocity": piston[1]}
    memory: list[float] = []
    sensors: list[int] = []
    for effect in effects():
        for kind in effect.memory:
            if effect.site == "sensor" and kind == "position":
                sensors.append(len(memory))
            memory.append(starts[kind])
    return np.array(memory or [0.0]), np.array(sensors, dtype=np.int64)
