"""A cascade: a position loop asks for a velocity, a velocity loop for volts; the force damps the oil's resonance."""

from __future__ import annotations

from math import exp

from eha_core.control.integrator import Integrator
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_model import velocity_gain

POSITION_GAIN = 60.0
"""1/s; as the PID's crossover."""

VELOCITY_GAIN = 0.3
"""Volts for a velocity error, in units of the volts that make this velocity [-]."""

RESET_TIME = 0.05
"""s; of the velocity loop's integral."""

FORCE_GAIN = 2e-5
"""V/N; takes volts away while the force rises."""

FORCE_CORNER = 50.0
"""rad/s; slower changes of the force are load, and are left alone."""


class Cascade(Controller):
    """v* = v_r + k_x e; u = v*/k_v + k (v* - v + integral / T_i)/k_v - k_F (F - F slow).

    Source: H. E. Merritt, "Hydraulic Control Systems", Wiley (1967), section 10-5 (dynamic pressure feedback).
    """

    def reset(self) -> None:
        """Forget what was seen."""
        self._volts = 1.0 / velocity_gain(self._parameters)
        self._share = 1.0 - exp(-FORCE_CORNER * self._period)
        self._slow_force: float | None = None
        self._integral = Integrator(self._period, self._largest)

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        wanted = target.velocity + POSITION_GAIN * (target.position - measured.position)
        error = wanted - measured.velocity
        slow = measured.force if self._slow_force is None else self._slow_force
        self._slow_force = slow + self._share * (measured.force - slow)
        correction = VELOCITY_GAIN * (error + self._integral.value / RESET_TIME)
        voltage = self._volts * (wanted + correction) - FORCE_GAIN * (measured.force - self._slow_force)
        self._integral.add(error, voltage)
        return self._limited(voltage)
