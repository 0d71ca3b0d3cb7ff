"""The effects' own states where they begin to act."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects

Array = NDArray[np.float64]

PISTON_STATES = ("position", "velocity", "pressure_a", "pressure_b")


def starting_memory(current: float, piston: Array) -> Array:
    """The effects' states at a valve current [A] and a piston's state (position, velocity, pressure A, pressure B)."""
    starts = {"zero": 0.0, "current": current, **dict(zip(PISTON_STATES, piston, strict=True))}
    return np.array([starts[kind] for effect in effects() for kind in effect.memory] or [0.0])


def start_memory(memory: Array, chosen: Sequence[bool], current: float, piston: Array) -> None:
    """Put the states of the chosen effects (catalogue order) where they are when an effect begins to act."""
    starting = starting_memory(current, piston)
    take = [is_chosen for effect, is_chosen in zip(effects(), chosen, strict=True) for _ in effect.memory] or [True]
    memory[take] = starting[take]


class Trailing(NamedTuple):
    """The memory slots of sensors that trail what they measure, and which of the piston's states each of them trails.

    Where the piston starts anew, such a slot starts from what the sensor showed then, as far as that was recorded.
    """

    slots: NDArray[np.int64]
    states: NDArray[np.int64]


@cache
def trailing() -> Trailing:
    """Those of the whole catalogue."""
    kinds = [(effect.site, kind) for effect in effects() for kind in effect.memory]
    found = [(slot, PISTON_STATES.index(kind)) for slot, (site, kind) in enumerate(kinds)
             if site == "sensor" and kind in PISTON_STATES]  # fmt: skip
    return Trailing(*np.array(found, dtype=np.int64).reshape(-1, 2).T)
