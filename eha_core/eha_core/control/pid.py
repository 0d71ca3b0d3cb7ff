"""PID with anti-windup: what a rig has before anybody knows its model."""

from __future__ import annotations

from eha_core.control.integrator import Integrator
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_model import velocity_gain

CROSSOVER = 60.0
"""rad/s; a third of the coil's corner R / L = 170 rad/s, which leaves about 60 degrees of phase margin."""

RESET_TIME = 0.1
"""s; six times the time constant of the position loop."""


class Pid(Controller):
    """u = k (e + integral of e / T_i - T_d v), the derivative on the measurement alone.

    T_d = L / R compensates for the coil's lag.
    """

    def reset(self) -> None:
        """Forget what was seen."""
        values = self._parameters
        self._gain = CROSSOVER / velocity_gain(values)
        self._derivative_time = values["coil_inductance"] / values["coil_resistance"]
        self._integral = Integrator(self._period, self._largest)

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        error = target.position - measured.position
        voltage = self._gain * (error + self._integral.value / RESET_TIME - self._derivative_time * measured.velocity)
        self._integral.add(error, voltage)
        return self._limited(voltage)
