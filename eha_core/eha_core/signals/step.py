"""One step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.signals.signal import FloatArray, Signal, described


@dataclass(frozen=True)
class Step(Signal):
    """Zero, and from `at` on the height."""

    height: float = described(0.01, "height of the step", "same")
    at: float = described(1.0, "instant of the step", "s", 0.0)

    def shape(self, time: FloatArray) -> FloatArray:
        """The step."""
        return np.where(time >= self.at * (1.0 - 1e-12), self.height, 0.0)
