"""A staircase up and down again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.signals.signal import FloatArray, Signal, described, ticks


@dataclass(frozen=True)
class Staircase(Signal):
    """Rises by `height` after every `dwell`, `steps` times, descends likewise, and repeats."""

    height: float = described(0.005, "height of one step", "same")
    dwell: float = described(1.0, "time spent on each step", "s", 1e-4)
    steps: int = described(4, "steps from the bottom to the top", "", 1, 10_000)

    def shape(self, time: FloatArray) -> FloatArray:
        """The staircase."""
        level = np.mod(ticks(time, self.dwell), 2 * self.steps)
        return np.asarray(self.height * np.minimum(level, 2 * self.steps - level))
