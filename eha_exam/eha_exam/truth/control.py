"""A position controller in the loop, as a rig that tracks a reference has one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class PositionController:
    """PI control of position at the sampling rate, held between samples.

    `reference` [m] has one value a sample, `gain` is in V/m, `integral_gain` in V/(m s), `limit` in V. `feedforward`
    [V] is added to the output; with it and a low gain the loop is a test signal that does not drift into an end.
    `noise` [m] is what the sensor adds to each sample the controller sees; a recording of the loop carries it too.
    """

    reference: NDArray[np.float64]
    gain: float
    integral_gain: float = 0.0
    limit: float = 10.0
    feedforward: NDArray[np.float64] | None = None
    noise: NDArray[np.float64] | None = None

    def command(self, sample: int, measured: float, integral: float) -> tuple[float, float]:
        """Voltage [V] at one sample and the error [m] to integrate, which is none while the output saturates."""
        seen = measured if self.noise is None else measured + self.noise[sample]
        error = float(self.reference[sample]) - seen
        wanted = self.gain * error + self.integral_gain * integral
        if self.feedforward is not None:
            wanted += float(self.feedforward[sample])
        voltage = min(max(wanted, -self.limit), self.limit)
        return voltage, error if voltage == wanted else 0.0
