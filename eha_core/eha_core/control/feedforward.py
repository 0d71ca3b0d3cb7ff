"""Feedforward through the inverse of a diagnosed model, friction included, with a small PI loop around it.

Made from a diagnosis' fitted.yaml it knows the rig's friction, leakage and valve as they were found; made from nominal
values it knows the data sheet's.
"""

from __future__ import annotations

from eha_core.control.integrator import Integrator
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.inverse_model import InverseModel
from eha_core.control.linear_model import velocity_gain
from eha_core.control.pid import CROSSOVER, RESET_TIME


class Feedforward(Controller):
    """The voltage that moves the modelled actuator along the reference, and the PID's P and I on what error remains."""

    def reset(self) -> None:
        """Forget what was seen."""
        self._gain = CROSSOVER / velocity_gain(self._parameters)
        self._inverse = InverseModel(self._parameters)
        self._integral = Integrator(self._period, self._largest)

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        error = target.position - measured.position
        feedback = self._gain * (error + self._integral.value / RESET_TIME)
        voltage = self._inverse.follow(target.position, target.velocity, self._period) + feedback
        self._integral.add(error, voltage)
        return self._limited(voltage)
