"""Trapezoidal pulses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eha_core.signals.signal import FloatArray, Signal, described


@dataclass(frozen=True)
class Trapezoid(Signal):
    """Ramps up, holds, ramps down and rests; every other pulse is negative where `mirrored`."""

    amplitude: float = described(0.01, "height of the pulses", "same")
    rise: float = described(0.5, "duration of each ramp", "s", 1e-4)
    hold: float = described(0.5, "time at the height", "s", 0.0)
    rest: float = described(0.5, "time at zero between pulses", "s", 0.0)
    mirrored: bool = described(True, "whether every other pulse is negative")

    @cached_property
    def _corners(self) -> tuple[FloatArray, FloatArray]:
        durations = [0.0, self.rise, self.hold, self.rise, self.rest]
        heights = np.array([0.0, 1.0, 1.0, 0.0, 0.0]) * self.amplitude
        if self.mirrored:
            durations += durations[1:]
            heights = np.append(heights, -heights[1:])
        return np.cumsum(durations), heights

    def shape(self, time: FloatArray) -> FloatArray:
        """The pulses."""
        instants, heights = self._corners
        return np.asarray(np.interp(np.mod(time, instants[-1]), instants, heights))

    def slope(self, time: FloatArray) -> FloatArray:
        """The ramps' rates."""
        instants, heights = self._corners
        piece = np.searchsorted(instants, np.mod(time, instants[-1]), side="right") - 1
        piece = np.minimum(piece, len(instants) - 2)
        durations = np.maximum(np.diff(instants), 1e-12)
        return np.asarray((np.diff(heights) / durations)[piece])
