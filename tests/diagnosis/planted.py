"""Every effect of the catalogue in a recording that shows it, behind wrong parameters."""

from __future__ import annotations

from collections.abc import Mapping

from made import recorded

from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.observation import Observation, observe
from eha_core.parameters import nominal_values

SIZES = {
    "end_stop": {"lower": -10.0, "upper": 0.008, "stiffness": 1e6, "damping": 1e3},
    "external_leakage": {"coefficient_a": 2e-12, "coefficient_b": 1e-12},
    "leakage_onset": {"time": 6.2, "internal_leakage": 5e-11},
    "stribeck_friction": {"force": 150.0, "static_force": 220.0, "stribeck_velocity": 0.03},
    "position_sensor_backlash": {"half_width": 4e-4},
    "hardening_spring": {"coefficient": 3e8},
    "command_delay": {"delay": 0.008},
}
"""Sizes other than typical where the test's motion, some 2 cm, asks for them."""

RIGS = {
    "entrained_air": {"supply_pressure": 4e6, "moving_mass": 150.0, "damping_coefficient": 600.0, "valve_gain": 4e-5},
    "load_friction": {"spring_stiffness": 2e5},
    "pressure_sensor_lag": {"moving_mass": 90.0},
}
"""Air compresses away at high pressure: it is looked for where pressure is low and a heavy load makes it swing.
Friction in proportion to a load that is viscous is more viscous friction: it is looked for under a spring.
Pressures that are both late by T look like those of a load lighter by T times its damping: most of the paper's mass."""

DURATIONS = {"leakage_onset": 10.0, "thermal_drift": 10.0}
"""s; what happens late, or slowly, asks for a longer record than others."""

NOT_IDENTIFIABLE = {"position_sensor_scale"}
"""Other parameters imitate all of it (gain, mass, damping scaled): no recording of these channels shows it."""


def planted(effect: Effect) -> tuple[Mapping[str, float], Mapping[str, float], Observation]:
    """What was planted, by full name; the nominal values; and the recording."""
    sizes = {**{row.name: row.typical for row in effect.parameters}, **SIZES.get(effect.id, {})}
    values = {f"{effect.id}.{name}": value for name, value in sizes.items()}
    rig = RIGS.get(effect.id, {})
    nominal = {**nominal_values(), **rig}
    other = {"moving_mass": 1.1 * nominal["moving_mass"], "damping_coefficient": 0.93 * nominal["damping_coefficient"]}
    recording = recorded({**rig, **values, **other}, seed=7, duration=DURATIONS.get(effect.id, 6.0))
    return values, nominal, observe(recording)


def require_measured(effect: Effect, values: Mapping[str, float], result: Fit) -> None:
    """The sizes that were planted are found, to a tenth or within the interval."""
    for row in effect.parameters:
        name = f"{effect.id}.{row.name}"
        if row.switches and values[name] != row.nominal:
            allowed = max(0.1 * abs(values[name] - row.nominal), 4.0 * result.deviation(name))
            assert abs(result.values[name] - values[name]) < allowed, name
