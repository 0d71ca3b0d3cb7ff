"""The voltage that moves a known actuator along a motion: its equations solved from the motion back to the volts.

It needs nothing but `math`, so that `eha export controller` can write this very text into a file of its own, with an
actuator's values below it. `eha_core/export/c/eha_controller.c` is the same law in C.
"""

from math import copysign, exp, sqrt, tanh

REVERSAL = 2e-3
"""m/s; the speed below which the compensated friction turns smoothly (assumed): a jump of it could not be followed."""

OVERLAP_ROUNDING = 1e-5
"""A; over at least so much opening the spool crosses its overlap (assumed): it cannot jump."""

LEAST_DROP = 1.0
"""Pa; what an orifice is taken to have where the load needs all of the supply pressure (assumed): no division by 0."""

LEAST_SHARE = 0.1
"""The smallest share of its gain that a saturating valve is taken to keep (assumed); the law stays finite."""

NAMES = (
    "moving_mass", "damping_coefficient", "directional_damping.ratio", "quadratic_damping.coefficient",
    "spring_stiffness", "hardening_spring.coefficient", "constant_load.force", "coulomb_friction.force",
    "stribeck_friction.force", "stribeck_friction.static_force", "stribeck_friction.stribeck_velocity",
    "stribeck_friction.shape", "presliding_friction.force", "presliding_friction.static_force",
    "presliding_friction.stribeck_velocity", "piston_area", "piston_area_b", "unequal_piston_area.ratio",
    "actuator_displacement", "line_volume", "bulk_modulus", "internal_leakage", "external_leakage",
    "external_leakage.coefficient_a", "external_leakage.coefficient_b", "turbulent_leakage.coefficient",
    "turbulent_leakage.transition_pressure", "supply_pressure", "return_pressure", "valve_gain",
    "flow_gain_asymmetry.ratio", "flow_saturation.curvature", "valve_deadband.half_width", "valve_deadband.rounding",
    "valve_null_offset.offset", "valve_damping_ratio", "valve_natural_frequency", "coil_resistance", "coil_inductance",
    "command_delay.delay",
)  # fmt: skip
"""The parameters that the law takes, by their catalogue names."""


class InverseModel:
    """The inverse of an actuator: SI units; the position is from mid stroke, positive motion extends.

    Args:
        values: the value of each of NAMES [SI]; others are ignored.
    """

    def __init__(self, values: dict[str, float]) -> None:
        self._values = {name: values[name] for name in NAMES}
        self._area_a = values["piston_area"]
        self._area_b = values["piston_area_b"] * values["unequal_piston_area.ratio"]
        self._area = 0.5 * (self._area_a + self._area_b)
        volume = self._area * values["actuator_displacement"] + values["line_volume"]
        self._compliance = 0.5 * volume / values["bulk_modulus"]  # of both chambers in series, m^3/Pa
        self._lag = values["coil_inductance"] / values["coil_resistance"]
        self._lag += 2.0 * values["valve_damping_ratio"] / values["valve_natural_frequency"]
        self.reset()

    def reset(self) -> None:
        """Forget the motion that `follow` has been given."""
        self._before: tuple[float, float, float] | None = None

    def follow(self, position: float, velocity: float, period: float, supply_pressure: float | None = None) -> float:
        """Volts for a motion that is given sample by sample, with the lags of oil, spool, coil and command.

        Accelerations and the rates of force and spool are backward differences; the first call takes them as zero.

        Args:
            position: to be followed [m].
            velocity: likewise [m/s].
            period: time since the last call, and for which the voltage is held [s]; above 0.
            supply_pressure: as measured, above the return line's reference [Pa]; None: as in the values.
        """
        velocity_before, force_before, spool_before = self._before or (velocity, 0.0, 0.0)
        supply = self._values["supply_pressure"] if supply_pressure is None else supply_pressure
        force = self.force(position, velocity, (velocity - velocity_before) / period)
        force_rate = (force - force_before) / period if self._before else 0.0
        spool = self.spool(*self.flows(velocity, force, force_rate, supply), force, supply)
        spool_rate = (spool - spool_before) / period if self._before else 0.0
        self._before = (velocity, force, spool)
        lead = self._lag + self._values["command_delay.delay"] + 0.5 * period  # half a period: the voltage is held
        return self._values["coil_resistance"] * (spool + lead * spool_rate)

    def voltage(
        self, position: float, velocity: float, acceleration: float, supply_pressure: float | None = None
    ) -> float:
        """Volts that hold a motion [m, m/s, m/s^2] when pressures, spool and coil have settled; see `follow`."""
        supply = self._values["supply_pressure"] if supply_pressure is None else supply_pressure
        force = self.force(position, velocity, acceleration)
        return self._values["coil_resistance"] * self.spool(*self.flows(velocity, force, 0.0, supply), force, supply)

    def friction(self, velocity: float) -> float:
        """Viscous and dry friction against a velocity [m/s], smooth about zero [N]."""
        values, speed = self._values, abs(velocity)
        dry = values["coulomb_friction.force"]
        for kind, shape in (("stribeck", values["stribeck_friction.shape"]), ("presliding", 2.0)):
            sliding, static = values[f"{kind}_friction.force"], values[f"{kind}_friction.static_force"]
            share = (speed / values[f"{kind}_friction.stribeck_velocity"]) ** shape
            dry += sliding + (static - sliding) * exp(-share)
        viscous = values["damping_coefficient"] * (1.0 + values["directional_damping.ratio"] * copysign(1.0, velocity))
        viscous += values["quadratic_damping.coefficient"] * speed
        return viscous * velocity + dry * tanh(velocity / REVERSAL)

    def force(self, position: float, velocity: float, acceleration: float) -> float:
        """What the pressures have to exert, A_p P1 - A_b P2, for a motion [m, m/s, m/s^2]; newtons."""
        values = self._values
        spring = values["spring_stiffness"] + values["hardening_spring.coefficient"] * position * position
        inertia = values["moving_mass"] * acceleration
        return inertia + self.friction(velocity) + spring * position + values["constant_load.force"]

    def pressures(self, velocity: float, force: float, supply_pressure: float) -> tuple[float, float]:
        """Chamber pressures in steady motion at a velocity [m/s] under a pressure force [N] and a supply [Pa].

        The flows A_p v and A_b v share the drops between the ports. Where the areas differ, the pressures of both
        directions do, too; they change over smoothly.
        """
        back, cubes = self._values["return_pressure"], self._area_a**3 + self._area_b**3
        extending = (self._area_a * supply_pressure - self._area_b * back - force) / cubes
        retracting = (self._area_b * supply_pressure - self._area_a * back + force) / cubes
        share = 0.5 + 0.5 * tanh(velocity / REVERSAL)
        square_a, square_b = self._area_a * self._area_a, self._area_b * self._area_b
        pressure_a = share * (supply_pressure - square_a * extending) + (1.0 - share) * (back + square_a * retracting)
        pressure_b = share * (back + square_b * extending) + (1.0 - share) * (supply_pressure - square_b * retracting)
        return pressure_a, pressure_b

    def flows(self, velocity: float, force: float, force_rate: float, supply_pressure: float) -> tuple[float, float]:
        """Flow into port A and out of port B [m^3/s] at a velocity [m/s], a pressure force [N, N/s] and a supply [Pa].

        They carry the piston, feed the leakage and compress the oil; both ports share what one chamber loses outwards.
        """
        values = self._values
        pressure_a, pressure_b = self.pressures(velocity, force, supply_pressure)
        load, transition = pressure_a - pressure_b, values["turbulent_leakage.transition_pressure"]
        outside_a = (values["external_leakage"] + values["external_leakage.coefficient_a"]) * pressure_a
        outside_b = (values["external_leakage"] + values["external_leakage.coefficient_b"]) * pressure_b
        lost = values["internal_leakage"] * load + 0.5 * (outside_a - outside_b)
        lost += values["turbulent_leakage.coefficient"] * load / sqrt(sqrt(load * load + transition * transition))
        lost += self._compliance * force_rate / self._area
        return self._area_a * velocity + lost, self._area_b * velocity + lost

    def spool(self, flow_a: float, flow_b: float, force: float, supply_pressure: float) -> float:
        """The valve's inverse: its spool position [A-equivalent] for flows [m^3/s] under a pressure force [N].

        Each port's flow is K x_v sqrt(drop), so A_p Q1^2 + A_b Q2^2 is (K x_v)^2 times the force that both drops make.
        """
        values = self._values
        square = (self._area_a * flow_a * abs(flow_a) + self._area_b * flow_b * abs(flow_b)) / (2.0 * self._area)
        extending = square >= 0.0
        driving, against = (self._area_a, self._area_b) if extending else (self._area_b, self._area_a)
        left = driving * supply_pressure - against * values["return_pressure"] - (force if extending else -force)
        drop = max(left / (2.0 * self._area), LEAST_DROP)
        gain = values["valve_gain"] * (1.0 if extending else 1.0 - values["flow_gain_asymmetry.ratio"])
        opening = copysign(sqrt(abs(square) / drop) / gain, square)
        opening /= max(1.0 - values["flow_saturation.curvature"] * abs(opening), LEAST_SHARE)
        rounding = max(values["valve_deadband.rounding"], OVERLAP_ROUNDING)
        crossed = values["valve_deadband.half_width"] * tanh(opening / rounding)
        return opening + crossed - values["valve_null_offset.offset"]
