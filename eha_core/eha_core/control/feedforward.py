"""Feedforward through the inverse of a diagnosed model, friction included, with a small PI loop around it.

Made from a diagnosis' fitted.yaml it knows the rig's friction, leakage and valve as they were found; made from nominal
values it knows the data sheet's.
"""

from __future__ import annotations

from math import copysign, sqrt, tanh

from eha_core.control.integrator import Integrator
from eha_core.control.interface import Controller, Measurement, Target
from eha_core.control.linear_model import velocity_gain

CROSSOVER = 60.0
"""rad/s; of the loop around the feedforward, as the PID's."""

RESET_TIME = 0.1
"""s; as the PID's."""

REVERSAL = 2e-3
"""m/s; the speed below which the compensated friction turns smoothly: a jump of it could not be followed."""


class Feedforward(Controller):
    """The voltage that moves the modelled actuator along the reference, and a PI law on what error remains.

    Force on the load, from that the pressures, flow, spool position and current, each with the rate that its lag asks
    for; rates are backward differences of the reference.
    """

    def reset(self) -> None:
        """Forget what was seen."""
        values = self._parameters
        self._gain = CROSSOVER / velocity_gain(values)
        self._area = 0.5 * (values["piston_area"] + values["piston_area_b"])
        volume = self._area * values["actuator_displacement"] + values["line_volume"]
        self._compliance = 0.5 * volume / values["bulk_modulus"]  # of both chambers in series, m^3/Pa
        lag = values["coil_inductance"] / values["coil_resistance"]
        lag += 2.0 * values["valve_damping_ratio"] / values["valve_natural_frequency"]
        self._lead = lag + values["command_delay.delay"] + 0.5 * self._period  # half a period: the command is held
        self._integral = Integrator(self._period, self._largest)
        self._before: tuple[float, float, float] | None = None

    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""
        error = target.position - measured.position
        feedback = self._gain * (error + self._integral.value / RESET_TIME)
        voltage = self._inverse(target) + feedback
        self._integral.add(error, voltage)
        return self._limited(voltage)

    def _inverse(self, target: Target) -> float:
        """Volts for the reference motion."""
        values = self._parameters
        velocity_before, load_before, spool_before = self._before or (target.velocity, 0.0, 0.0)
        acceleration = (target.velocity - velocity_before) / self._period
        load = self._load_pressure(target, acceleration)
        load_rate = (load - load_before) / self._period if self._before else 0.0
        leak = values["internal_leakage"] + 0.5 * values["external_leakage"]
        turbulent = values["turbulent_leakage.coefficient"] * copysign(sqrt(abs(load)), load)
        flow = self._area * target.velocity + leak * load + turbulent + self._compliance * load_rate
        drop = values["supply_pressure"] - values["return_pressure"] - copysign(load, flow * load) * (load != 0.0)
        opening = flow / (values["valve_gain"] * sqrt(max(0.5 * drop, 1.0)))
        spool = self._through_deadband(opening) - values["valve_null_offset.offset"]
        spool_rate = (spool - spool_before) / self._period if self._before else 0.0
        self._before = (target.velocity, load, spool)
        return values["coil_resistance"] * (spool + self._lead * spool_rate)

    def _load_pressure(self, target: Target, acceleration: float) -> float:
        """P1 - P2 that carries mass, damping, spring, friction and load [Pa]."""
        values = self._parameters
        friction = values["coulomb_friction.force"] + values["stribeck_friction.force"]
        force = values["moving_mass"] * acceleration + values["damping_coefficient"] * target.velocity
        force += values["spring_stiffness"] * target.position + friction * tanh(target.velocity / REVERSAL)
        return (force + values["constant_load.force"]) / self._area

    def _through_deadband(self, opening: float) -> float:
        """The spool position that opens the valve so far, over its overlap."""
        width = self._parameters["valve_deadband.half_width"]
        rounding = max(self._parameters["valve_deadband.rounding"], 1e-5)  # A; the overlap cannot be jumped
        return opening + width * tanh(opening / rounding)
