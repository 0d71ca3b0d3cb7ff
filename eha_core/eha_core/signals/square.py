"""A square wave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.signals.signal import EDGE, FloatArray, Signal, described


@dataclass(frozen=True)
class Square(Signal):
    """+amplitude for the first part of each period, -amplitude for the rest."""

    amplitude: float = described(0.01, "height above and below the middle", "same")
    frequency: float = described(1.0, "frequency", "Hz", 1e-6, 1e4)
    duty: float = described(0.5, "part of each period that is positive", "", 0.0, 1.0)

    def shape(self, time: FloatArray) -> FloatArray:
        """The square wave."""
        phase = np.mod(time * self.frequency + EDGE, 1.0)
        return np.where(phase < self.duty, self.amplitude, -self.amplitude)
