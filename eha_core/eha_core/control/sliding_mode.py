"""Sliding mode: the error is driven onto a line in the phase plane and held there, whatever disturbs it."""

from __future__ import annotations

from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_model import velocity_gain

SLOPE = 60.0
"""1/s; how fast the error falls along the line: the PID's crossover."""

SWITCHING = 0.15
"""V; the switched voltage, which must exceed what the disturbances are worth."""

BOUNDARY = 0.1
"""m/s; within this distance of the line the switch is a straight one. Less follows better, and chatters."""


class SlidingMode(Controller):
    """s = e' + slope e; u = (v_r + slope e)/k_v + switching sat(s / boundary).

    Source: J.-J. E. Slotine, W. Li, "Applied Nonlinear Control", Prentice Hall (1991), chapter 7.
    """

    def reset(self) -> None:
        """Forget what was seen."""
        self._volts = 1.0 / velocity_gain(self._parameters)

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        error = target.position - measured.position
        distance = target.velocity - measured.velocity + SLOPE * error
        switched = min(max(distance / BOUNDARY, -1.0), 1.0)
        return self._limited(self._volts * (target.velocity + SLOPE * error) + SWITCHING * switched)
