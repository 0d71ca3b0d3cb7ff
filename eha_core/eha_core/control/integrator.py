"""An integral that stands still while the drive is at its limit and the error would push it further: anti-windup."""

from __future__ import annotations


class Integrator:
    """Sums an error over time by rectangles, with conditional integration.

    Source: K. J. Astrom, T. Hagglund, "Advanced PID Control", ISA (2006), section 3.5.
    """

    def __init__(self, period: float, largest: float) -> None:
        self._period = period
        self._largest = largest
        self.value = 0.0

    def add(self, error: float, voltage: float) -> None:
        """Take one error, unless the unlimited `voltage` [V] is beyond its limit in the same direction."""
        if abs(voltage) <= self._largest or voltage * error < 0.0:
            self.value += error * self._period
