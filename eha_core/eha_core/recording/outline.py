"""The outline of a signal for a small plot: lowest and highest value in each of some hundred stretches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eha_core.recording.channel_kinds import FloatArray

STRETCHES = 150
"""Fewest stretches of an outline of at least as many values; at most there are twice as many (assumed: a small plot is
300 pixels wide)."""

Pairs = tuple[tuple[float, float], ...]


class Outline:
    """Takes the values of a signal part by part, and keeps only the outline."""

    def __init__(self) -> None:
        self._width = 1
        self._pairs: FloatArray = np.empty((0, 2))
        self._rest: FloatArray = np.empty(0)

    def add(self, values: NDArray[np.generic]) -> None:
        """Take the values that follow; those that are not finite leave a gap."""
        numbers = values.astype(np.float64)
        rest = np.concatenate([self._rest, np.where(np.isfinite(numbers), numbers, np.nan)])
        while len(rest) >= self._width:
            room = 2 * STRETCHES - len(self._pairs)
            if not room:
                self._pairs = _extremes(self._pairs.reshape(STRETCHES, 4))
                self._width *= 2
                continue
            count = min(len(rest) // self._width, room)
            taken = rest[: count * self._width].reshape(count, self._width)
            self._pairs = np.concatenate([self._pairs, _extremes(taken)])
            rest = rest[count * self._width :]
        self._rest = rest

    def pairs(self) -> Pairs:
        """Lowest and highest value of each stretch; NaN where it has none."""
        last = _extremes(self._rest[None, :]) if len(self._rest) else np.empty((0, 2))
        return tuple((float(low), float(high)) for low, high in np.concatenate([self._pairs, last]))


def _extremes(rows: FloatArray) -> FloatArray:
    return np.stack([np.fmin.reduce(rows, axis=1), np.fmax.reduce(rows, axis=1)], axis=1)
