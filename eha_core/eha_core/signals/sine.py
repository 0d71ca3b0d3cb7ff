"""A sine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.signals.signal import FloatArray, Signal, described


@dataclass(frozen=True)
class Sine(Signal):
    """amplitude * sin(2 pi frequency t + phase)."""

    amplitude: float = described(8.4e-3, "height of the sine", "same")
    frequency: float = described(1.0, "frequency", "Hz", 0.0, 1e4)
    phase: float = described(0.0, "phase at time 0", "rad")

    def shape(self, time: FloatArray) -> FloatArray:
        """The sine."""
        return self.amplitude * np.sin(2.0 * np.pi * self.frequency * time + self.phase)

    def slope(self, time: FloatArray) -> FloatArray:
        """Its derivative."""
        rate = 2.0 * np.pi * self.frequency
        return self.amplitude * rate * np.cos(rate * time + self.phase)
