"""What the truth is made of: one numeric record of every plant and effect parameter, and how a case fills it.

The names of plant and effect parameters are those of the catalogue; a `law` picks one of several published forms of the
same phenomenon. Effects that the catalogue does not know carry names of their own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from eha_exam.errors import ExamError

Effect = tuple[str, Mapping[str, float | str]]

PLANT: dict[str, float] = {
    "coil_resistance": 100.0,
    "coil_inductance": 0.59,
    "saturation_current": 0.02,
    "valve_damping_ratio": 0.48,
    "valve_natural_frequency": 543.0,
    "valve_gain": 2.38e-5,
    "bulk_modulus": 1.4e9,
    "supply_pressure": 2.1e7,
    "return_pressure": 0.0,
    "spring_stiffness": 10.0,
    "actuator_displacement": 0.1,
    "piston_area": 645e-6,
    "piston_area_b": 645e-6,
    "moving_mass": 9.0,
    "damping_coefficient": 2000.0,
    "internal_leakage": 1e-12,
    "external_leakage": 0.0,
    "line_volume": 1e-5,
    "atmospheric_pressure": 101325.0,
    "transition_pressure": 3e3,
}
"""Table 1 of the source paper; the pressure [Pa] below which an orifice's flow turns laminar is assumed."""

PUMP: dict[str, float] = {
    "pump_displacement": 0.0,
    "pump_leakage": 0.0,
    "pump_relief_gain": 0.0,
    "pump_line_volume": 1e-4,
    "pump_bypass_gain": 0.0,
    "pump_bypass_spool": 1e-4,
    "pump_speed": 0.0,
}
"""A pump in place of the constant supply, where its displacement [m^3/rad] is not zero.

Its line, of pump_line_volume [m^3], gets displacement |speed|. It loses pump_leakage [m^3/(s Pa)], what the relief
valve lets through above supply_pressure (pump_relief_gain [m^3/(s Pa)]), what the valve's lands take and, while the
spool is within pump_bypass_spool [A] of its middle, a bypass to the tank (pump_bypass_gain [m^(7/2) kg^(-1/2)]): a
tandem centre. The lands are those of the servo valve. pump_speed [rad/s] is what the recording has at the moment.
"""

LAWS: dict[str, dict[str, int]] = {
    "stribeck_friction": {"gaussian": 0, "tustin": 1, "hess_soom": 2},
    "presliding_friction": {"lugre": 0, "lugre_tustin": 1, "maxwell_slip": 2, "bouc_wen": 3},
    "entrained_air": {"cho": 0, "nykanen": 1},
    "end_stop": {"kelvin_voigt": 0, "hunt_crossley": 1},
    "load_friction": {"proportional": 0, "elastic": 1},
    "flow_saturation": {"hyperbolic": 0, "in_series": 1},
    "bore_wear_leakage": {"bell": 0, "gaussian": 1, "clearance": 2},
    "pressure_sensor_lag": {"first_order": 0, "critically_damped": 1},
}
"""Published forms of one phenomenon. The first of each is the one whose parameters can be scored."""

CATALOGUE: dict[str, dict[str, float]] = {
    "command_delay": {"delay": 0.0},
    "spool_hysteresis": {"half_width": 0.0},
    "valve_deadband": {"half_width": 0.0, "rounding": 0.0},
    "valve_null_offset": {"offset": 0.0},
    "flow_gain_asymmetry": {"ratio": 0.0},
    "valve_null_leakage": {"conductance": 0.0, "width": 1.0, "underlap": 0.0},
    "supply_pressure_droop": {"resistance": 0.0, "time_constant": 1.0},
    "return_back_pressure": {"resistance": 0.0, "time_constant": 1.0},
    "turbulent_leakage": {"coefficient": 0.0, "transition_pressure": PLANT["transition_pressure"]},
    "external_leakage": {"coefficient_a": 0.0, "coefficient_b": 0.0},
    "entrained_air": {"air_fraction": 0.0},
    "unequal_piston_area": {"ratio": 1.0},
    "coulomb_friction": {"force": 0.0},
    "stribeck_friction": {"force": 0.0, "static_force": 0.0, "stribeck_velocity": 1.0, "shape": 2.0},
    "presliding_friction": {
        "force": 0.0,
        "static_force": 0.0,
        "stribeck_velocity": 1.0,
        "stiffness": 0.0,
        "damping": 0.0,
    },
    "quadratic_damping": {"coefficient": 0.0},
    "constant_load": {"force": 0.0},
    "hardening_spring": {"coefficient": 0.0},
    "end_stop": {"lower": -1e9, "upper": 1e9, "stiffness": 0.0, "damping": 0.0},
    "position_sensor_lag": {"time_constant": 0.0},
    "position_sensor_backlash": {"half_width": 0.0},
    "position_sensor_scale": {"ratio": 0.0},
    "pressure_sensor_bias": {"bias_a": 0.0, "bias_b": 0.0},
    "leakage_onset": {"time": 0.0, "internal_leakage": 0.0},
    "thermal_drift": {"damping_ratio": 0.0, "leakage_ratio": 0.0, "time_constant": 1.0},
    "directional_damping": {"ratio": 0.0},
    "load_friction": {"coefficient": 0.0},
    "flow_saturation": {"curvature": 0.0},
    "pressure_sensor_scale": {"ratio_a": 0.0, "ratio_b": 0.0},
    "position_sensor_offset": {"offset": 0.0},
    "bore_wear_leakage": {"coefficient": 0.0, "centre": 0.0, "width": 1.0},
    "pressure_sensor_lag": {"time_constant_a": 0.0, "time_constant_b": 0.0},
}
"""Neutral values of the catalogue's effects."""

OUTSIDE: dict[str, dict[str, float]] = {
    "position_ripple": {"force": 0.0, "pitch": 1.0, "phase": 0.0},
    "periodic_force": {"force": 0.0, "frequency": 1.0},
    "direction_friction": {"forward": 0.0, "backward": 0.0},
    "position_damping": {"coefficient": 0.0},
    "one_sided_spring": {"start": 0.0, "stiffness": 0.0},
    "relief_leakage": {"coefficient": 0.0, "opening": 0.0, "direction": 1.0},
}
"""Neutral values of the effects that the catalogue does not know.

position_ripple: force sin(2 pi x / pitch + phase); periodic_force: force sin(2 pi f t); direction_friction: Coulomb of
another height each way; position_damping: damping coefficient x^2 [N s/m^3]; one_sided_spring: stiffness past
x = start; relief_leakage: a relief valve across the piston that leaks one way, from A to B where direction is 1 and
from B to A where it is -1: coefficient [m^3/(s Pa)] times what the pressure difference is above opening [Pa].
"""

EFFECTS = CATALOGUE | OUTSIDE


def _field_names() -> list[str]:
    names = [*PLANT, *PUMP]
    for effect, parameters in EFFECTS.items():
        names += [f"{effect}_{name}" for name in parameters]
        names += [f"{effect}_law"] if effect in LAWS else []
    return names


RECORD_TYPE = np.dtype([(name, np.float64) for name in _field_names()])


def effect_parameters(effect: str) -> tuple[str, ...]:
    """Names of an effect's parameters, `window` and `law` apart; ExamError when there is no such effect."""
    if effect not in EFFECTS:
        raise ExamError(f"effect {effect!r} is not one the truth knows; give one of {', '.join(EFFECTS)}")
    return tuple(EFFECTS[effect])


def neutral_record(plant: Mapping[str, float]) -> NDArray[np.void]:
    """The record (one element) of a plant with no effect; `plant` overrides Table 1."""
    record = np.zeros(1, RECORD_TYPE)
    for effect, parameters in EFFECTS.items():
        for name, value in parameters.items():
            record[f"{effect}_{name}"] = value
    known = PLANT | PUMP
    for name, value in (known | dict(plant)).items():
        if name not in known:
            raise ExamError(f"plant parameter {name!r} is not one the truth knows; give one of {', '.join(known)}")
        record[name] = value
    return record


def with_effect(record: NDArray[np.void], effect: Effect) -> NDArray[np.void]:
    """A copy of the record with one effect switched on."""
    name, values = effect
    known = effect_parameters(name)
    record = record.copy()
    for parameter, value in values.items():
        if parameter == "law" and value in LAWS.get(name, {}):
            record[f"{name}_law"] = LAWS[name][str(value)]
        elif parameter in known:
            record[f"{name}_{parameter}"] = float(value)
        else:
            raise ExamError(f"effect {name} has no parameter {parameter} = {value!r}; give {', '.join(known)}")
    if name == "leakage_onset":
        record["internal_leakage"] = record["leakage_onset_internal_leakage"]
    if name == "unequal_piston_area":
        record["piston_area_b"] = record["piston_area"] * record["unequal_piston_area_ratio"]
    return record


def schedule(
    plant: Mapping[str, float], effects: Sequence[Effect], windows: Mapping[str, tuple[float, float]]
) -> list[tuple[float, NDArray[np.void]]]:
    """The records in force and the times [s] from which they are, in order; the first starts at minus infinity.

    `windows` gives the time [s] over which an effect acts; an effect without one acts always, a leakage's onset from
    its time on.
    """
    spans = {name: windows.get(name, (-np.inf, np.inf)) for name, _ in effects}
    for name, values in effects:
        if name == "leakage_onset":
            spans[name] = (float(values["time"]), np.inf)
    times = sorted({-np.inf} | {edge for span in spans.values() for edge in span if np.isfinite(edge)})
    plan = []
    for time in times:
        record = neutral_record(plant)
        for effect in effects:
            if spans[effect[0]][0] <= time < spans[effect[0]][1]:
                record = with_effect(record, effect)
        plan.append((time, record))
    return plan
