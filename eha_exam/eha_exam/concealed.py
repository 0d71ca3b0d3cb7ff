"""What a case conceals: the size at which each effect matters on a given rig and test, and the site it belongs to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eha_exam.plants import Rig

Parameters = dict[str, float | str]

SITES = {
    "command_delay": "command",
    "spool_hysteresis": "spool",
    "valve_deadband": "orifice",
    "valve_null_offset": "orifice",
    "flow_gain_asymmetry": "orifice",
    "valve_null_leakage": "orifice",
    "supply_pressure_droop": "supply",
    "return_back_pressure": "supply",
    "turbulent_leakage": "chamber",
    "external_leakage": "chamber",
    "entrained_air": "chamber",
    "unequal_piston_area": "chamber",
    "coulomb_friction": "force",
    "stribeck_friction": "force",
    "presliding_friction": "force",
    "quadratic_damping": "force",
    "constant_load": "force",
    "hardening_spring": "force",
    "end_stop": "force",
    "position_sensor_lag": "sensor",
    "position_sensor_backlash": "sensor",
    "position_sensor_scale": "sensor",
    "pressure_sensor_bias": "sensor",
    "leakage_onset": "schedule",
    "thermal_drift": "schedule",
    "directional_damping": "force",
    "pressure_sensor_scale": "sensor",
    "position_sensor_offset": "sensor",
    "position_ripple": "force",
    "periodic_force": "force",
    "direction_friction": "force",
    "load_friction": "force",
    "position_damping": "force",
    "one_sided_spring": "force",
    "relief_leakage": "chamber",
    "flow_saturation": "orifice",
    "bore_wear_leakage": "chamber",
    "pressure_sensor_lag": "sensor",
}
"""Site of each effect, the catalogue's and those outside of it."""

EQUIVALENT: dict[str, tuple[str, ...]] = {
    "direction_friction": ("coulomb_friction", "constant_load"),
    "one_sided_spring": ("end_stop",),
}
"""Effects outside the catalogue that some of its effects express exactly; naming those is right too."""

OTHER_LAWS: dict[str, tuple[Parameters, ...]] = {
    "stribeck_friction": ({"law": "tustin"}, {"law": "hess_soom"}),
    "presliding_friction": ({"law": "lugre_tustin"}, {"law": "maxwell_slip"}, {"law": "bouc_wen"}),
    "entrained_air": ({"law": "nykanen"},),
    "end_stop": ({"law": "hunt_crossley"},),
    "load_friction": ({"law": "elastic"},),
    "flow_saturation": ({"law": "in_series"},),
    "valve_deadband": ({"law": "rounded"},),
    "valve_null_leakage": ({"law": "underlap"},),
    "bore_wear_leakage": ({"law": "gaussian"}, {"law": "clearance"}),
    "pressure_sensor_lag": ({"law": "critically_damped"},),
}
"""Effects that the literature writes in more than one way, and the ways that the catalogue does not use."""


@dataclass(frozen=True)
class Setting:
    """What an effect's size is measured against: the rig and what its test makes it do.

    `amplitude` [m] and `speed` [m/s] are the largest of the reference, `duration` [s] is the recording's length.
    """

    rig: Rig
    amplitude: float
    speed: float
    duration: float

    @property
    def force(self) -> float:
        """Stall force [N]."""
        return self.rig.stall_force

    @property
    def spool(self) -> float:
        """Spool opening at the largest speed [A]."""
        return self.speed / self.rig.speed_per_ampere(1.0)

    @property
    def flow(self) -> float:
        """Flow into chamber A at the largest speed [m^3/s]."""
        return self.speed * self.rig.values["piston_area"]

    @property
    def resting_difference(self) -> float:
        """Pressure across the piston's seal at rest, which a rod makes [Pa]; chamber B's is the higher one."""
        return abs(1.0 - self.rig.area_ratio) / (1.0 + self.rig.area_ratio) * self.rig.values["supply_pressure"]

    @property
    def pressure_difference(self) -> float:
        """Pressure across the piston's seal at the largest speed: damping, and what a rod's side bears at rest [Pa]."""
        damped = self.rig.values["damping_coefficient"] * self.speed / self.rig.values["piston_area"]
        return self.resting_difference + damped


Draw = Callable[[Setting, Callable[[float, float], float], Callable[[], float]], Parameters]


def _friction(s: Setting, u: Callable[[float, float], float]) -> Parameters:
    force = u(0.01, 0.04) * s.force
    return {"force": force, "static_force": force * u(1.3, 1.9), "stribeck_velocity": u(0.04, 0.2) * s.speed}


def _presliding(s: Setting, u: Callable[[float, float], float]) -> Parameters:
    friction = _friction(s, u)
    stiffness = float(friction["force"]) / u(1e-5, 8e-5)
    damping = u(0.2, 0.8) * np.sqrt(stiffness * s.rig.values["moving_mass"])
    return friction | {"stiffness": stiffness, "damping": float(damping)}


def _stop(s: Setting, u: Callable[[float, float], float]) -> Parameters:
    stiffness = s.force / u(0.5e-3, 3e-3)
    damping = u(0.1, 0.5) * np.sqrt(stiffness * s.rig.values["moving_mass"])
    limits: Parameters = {"lower": -1.0, "upper": u(0.5, 0.8) * s.amplitude}
    return limits | {"stiffness": stiffness, "damping": float(damping)}


def _relief(s: Setting, u: Callable[[float, float], float], sign: Callable[[], float]) -> Parameters:
    """One way: with a rod, the way in which the pressures lie at rest."""
    direction = sign() if s.resting_difference == 0.0 else -1.0
    swing = s.pressure_difference - s.resting_difference
    opening = s.resting_difference + u(0.1, 0.4) * swing
    coefficient = u(0.2, 0.8) * s.flow / (s.pressure_difference - opening)
    return {"coefficient": coefficient, "opening": opening, "direction": direction}


def _late(u: Callable[[float, float], float], sign: Callable[[], float]) -> Parameters:
    """Both pressures late, or, as often, only that of one chamber."""
    which = sign() + sign()
    late_a, late_b = u(3e-3, 15e-3), u(3e-3, 15e-3)
    return {"time_constant_a": late_a if which >= 0.0 else 0.0, "time_constant_b": late_b if which <= 0.0 else 0.0}


def _conductance(s: Setting) -> float:
    """Leakage [m^3/(s Pa)] that would take the whole flow at the largest speed; A^2 / B for a symmetric cylinder."""
    return s.flow / s.pressure_difference


DRAWS: dict[str, Draw] = {
    "command_delay": lambda s, u, sign: {"delay": u(3e-3, 15e-3)},
    "spool_hysteresis": lambda s, u, sign: {"half_width": u(0.04, 0.15) * s.spool},
    "valve_deadband": lambda s, u, sign: {"half_width": u(0.04, 0.15) * s.spool},
    "valve_null_offset": lambda s, u, sign: {"offset": sign() * u(0.03, 0.12) * s.spool},
    "flow_gain_asymmetry": lambda s, u, sign: {"ratio": sign() * u(0.08, 0.3)},
    "valve_null_leakage": lambda s, u, sign: {
        "conductance": u(0.05, 0.2) * s.flow / s.rig.values["supply_pressure"],
        "width": u(0.1, 0.4) * s.spool,
    },
    "supply_pressure_droop": lambda s, u, sign: {
        "resistance": u(0.15, 0.4) * s.rig.values["supply_pressure"] / s.flow,
        "time_constant": u(0.02, 0.3),
    },
    "return_back_pressure": lambda s, u, sign: {
        "resistance": u(0.05, 0.2) * s.rig.values["supply_pressure"] / s.flow,
        "time_constant": u(0.02, 0.3),
    },
    "turbulent_leakage": lambda s, u, sign: {"coefficient": u(0.1, 0.4) * s.flow / np.sqrt(s.pressure_difference)},
    "external_leakage": lambda s, u, sign: {
        "coefficient_a": u(0.03, 0.15) * s.flow / s.rig.values["supply_pressure"],
        "coefficient_b": u(0.03, 0.15) * s.flow / s.rig.values["supply_pressure"],
    },
    "entrained_air": lambda s, u, sign: {"air_fraction": u(0.01, 0.05)},
    "unequal_piston_area": lambda s, u, sign: {"ratio": s.rig.area_ratio * u(0.82, 0.95)},
    "coulomb_friction": lambda s, u, sign: {"force": u(0.01, 0.04) * s.force},
    "stribeck_friction": lambda s, u, sign: _friction(s, u),
    "presliding_friction": lambda s, u, sign: _presliding(s, u),
    "quadratic_damping": lambda s, u, sign: {"coefficient": u(0.02, 0.08) * s.force / s.speed**2},
    "constant_load": lambda s, u, sign: {"force": sign() * u(0.02, 0.1) * s.force},
    "hardening_spring": lambda s, u, sign: {"coefficient": u(0.03, 0.12) * s.force / s.amplitude**3},
    "end_stop": lambda s, u, sign: _stop(s, u),
    "position_sensor_lag": lambda s, u, sign: {"time_constant": u(3e-3, 15e-3)},
    "position_sensor_backlash": lambda s, u, sign: {"half_width": u(1e-4, 4e-4)},
    "position_sensor_scale": lambda s, u, sign: {"ratio": sign() * u(0.03, 0.1)},
    "pressure_sensor_bias": lambda s, u, sign: {
        "bias_a": sign() * u(0.01, 0.04) * s.rig.values["supply_pressure"],
        "bias_b": sign() * u(0.01, 0.04) * s.rig.values["supply_pressure"],
    },
    "leakage_onset": lambda s, u, sign: {
        "time": u(0.25, 0.7) * s.duration,
        "internal_leakage": u(0.1, 0.5) * _conductance(s),
    },
    "thermal_drift": lambda s, u, sign: {
        "damping_ratio": u(0.3, 0.6),
        "leakage_ratio": u(0.05, 0.2) * _conductance(s) / s.rig.values["internal_leakage"],
        "time_constant": u(0.2, 0.5) * s.duration,
    },
    "load_friction": lambda s, u, sign: {"coefficient": u(0.1, 0.3) * s.rig.values["piston_area"]},
    "flow_saturation": lambda s, u, sign: {"curvature": u(0.25, 0.7) / s.spool},
    "pressure_sensor_scale": lambda s, u, sign: {"ratio_a": sign() * u(0.03, 0.1), "ratio_b": sign() * u(0.03, 0.1)},
    "position_sensor_offset": lambda s, u, sign: {
        "offset": sign() * u(0.15, 0.4) * s.rig.values["actuator_displacement"]
    },
    "directional_damping": lambda s, u, sign: {"ratio": sign() * u(0.25, 0.6)},
    "position_ripple": lambda s, u, sign: {
        "force": u(0.01, 0.04) * s.force,
        "pitch": u(0.2, 0.6) * s.amplitude,
        "phase": u(0.0, 6.28),
    },
    "periodic_force": lambda s, u, sign: {"force": u(0.01, 0.04) * s.force, "frequency": u(0.7, 6.0)},
    "direction_friction": lambda s, u, sign: {
        "forward": u(0.005, 0.015) * s.force,
        "backward": u(0.025, 0.05) * s.force,
    },
    "position_damping": lambda s, u, sign: {
        "coefficient": u(1.0, 4.0) * s.rig.values["damping_coefficient"] / s.amplitude**2
    },
    "one_sided_spring": lambda s, u, sign: {
        "start": u(-0.3, 0.3) * s.amplitude,
        "stiffness": u(0.04, 0.12) * s.force / s.amplitude,
    },
    "relief_leakage": _relief,
    "bore_wear_leakage": lambda s, u, sign: {
        "coefficient": u(0.2, 0.8) * _conductance(s),
        "centre": u(-0.4, 0.4) * s.amplitude,
        "width": u(0.15, 0.4) * s.amplitude,
    },
    "pressure_sensor_lag": lambda s, u, sign: _late(u, sign),
}
"""Normal sizes, such that each effect matters on its rig (assumed; stated beside the exam's table)."""

SIZES: dict[str, tuple[str, ...]] = {
    "command_delay": ("delay",),
    "spool_hysteresis": ("half_width",),
    "valve_deadband": ("half_width",),
    "valve_null_offset": ("offset",),
    "flow_gain_asymmetry": ("ratio",),
    "valve_null_leakage": ("conductance",),
    "supply_pressure_droop": ("resistance",),
    "return_back_pressure": ("resistance",),
    "turbulent_leakage": ("coefficient",),
    "external_leakage": ("coefficient_a", "coefficient_b"),
    "entrained_air": ("air_fraction",),
    "coulomb_friction": ("force",),
    "stribeck_friction": ("force", "static_force"),
    "presliding_friction": ("force", "static_force", "stiffness", "damping"),
    "quadratic_damping": ("coefficient",),
    "constant_load": ("force",),
    "hardening_spring": ("coefficient",),
    "position_sensor_lag": ("time_constant",),
    "position_sensor_backlash": ("half_width",),
    "position_sensor_scale": ("ratio",),
    "pressure_sensor_bias": ("bias_a", "bias_b"),
    "leakage_onset": ("internal_leakage",),
    "thermal_drift": ("damping_ratio", "leakage_ratio"),
    "directional_damping": ("ratio",),
    "pressure_sensor_scale": ("ratio_a", "ratio_b"),
    "position_sensor_offset": ("offset",),
    "load_friction": ("coefficient",),
    "flow_saturation": ("curvature",),
    "position_ripple": ("force",),
    "periodic_force": ("force",),
    "direction_friction": ("forward", "backward"),
    "position_damping": ("coefficient",),
    "one_sided_spring": ("stiffness",),
    "relief_leakage": ("coefficient",),
    "bore_wear_leakage": ("coefficient",),
    "pressure_sensor_lag": ("time_constant_a", "time_constant_b"),
}
"""Parameters that a smaller effect of the same kind has smaller; the others are its shape. A stop has only a shape."""


def draw_effect(
    effect: str, setting: Setting, generator: np.random.Generator, share: float = 1.0, other_law: bool = False
) -> Parameters:
    """An effect at `share` of its normal size, in the catalogue's law or another published one."""

    def uniform(low: float, high: float) -> float:
        return float(generator.uniform(low, high))

    def sign() -> float:
        return float(generator.choice((-1.0, 1.0)))

    values = scaled(effect, DRAWS[effect](setting, uniform, sign), share, setting.rig.area_ratio)
    return _in_other_law(effect, values, setting, generator) if other_law else values


def scaled(effect: str, values: Parameters, share: float, area_ratio: float) -> Parameters:
    """The effect at a share of its size, with its shape as it was; `area_ratio` is A_b / A_a of the rig."""
    smaller = {name: share * float(value) if name in SIZES.get(effect, ()) else value for name, value in values.items()}
    if effect == "unequal_piston_area":
        smaller["ratio"] = area_ratio + share * (float(values["ratio"]) - area_ratio)
    return smaller


def _in_other_law(effect: str, values: Parameters, setting: Setting, generator: np.random.Generator) -> Parameters:
    chosen = str(generator.choice([str(option["law"]) for option in OTHER_LAWS[effect]]))
    if chosen == "rounded":
        return values | {"rounding": 0.3 * float(values["half_width"])}
    if chosen == "underlap":
        return {"underlap": float(generator.uniform(0.05, 0.2)) * setting.spool}
    if chosen == "hunt_crossley":
        depth = 1e-3
        return values | {
            "law": chosen,
            "stiffness": float(values["stiffness"]) / np.sqrt(depth),
            "damping": 0.5 / setting.speed,
        }
    return values | {"law": chosen}
