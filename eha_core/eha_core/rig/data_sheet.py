"""What is asked about a rig: the lines of data sheets from which the plant's parameters follow."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import isfinite

from eha_core.errors import ParameterError, remedy
from eha_core.unit_names import UNITS, unit_named


@dataclass(frozen=True)
class Datum:
    """One line of a data sheet.

    Attributes:
        name: how it is called here; the command line's option with dashes.
        si: the SI unit in which it is held; empty for a number without one.
        meaning: what it is, as a person is asked for it.
        example: how it may be written.
        least: the smallest value that makes sense [SI].
        tells: a parameter that follows from it; a rig whose source has none such is not asked after the line.
    """

    name: str
    si: str
    meaning: str
    example: str
    least: float = 0.0
    tells: str = ""


DATA: tuple[Datum, ...] = (
    Datum("rated_flow", "m^3/s", "flow through the valve at its rated signal", "40 l/min", 1e-9, tells="valve_gain"),
    Datum("rated_pressure_drop", "Pa", "pressure drop over both edges of the valve at that flow",
        "70 bar", 1e3, tells="valve_gain"),
    Datum("rated_voltage", "V", "command at which the valve is fully open", "10 V", 1e-6, tells="coil_resistance"),
    Datum("rated_current", "A", "coil current at that command; unknown where electronics hide it",
        "40 mA", 1e-6, tells="valve_gain"),
    Datum("coil_inductance", "H", "inductance of the coil", "590 mH", 1e-6, tells="coil_inductance"),
    Datum("valve_frequency", "rad/s",
        "frequency at which the valve lags its command by 90 degrees", "90 Hz", 1e-3, tells="valve_natural_frequency"),
    Datum("valve_damping", "", "damping ratio of the valve", "0.7", 1e-3, tells="valve_damping_ratio"),
    Datum("bore", "m", "diameter of the piston", "40 mm", 1e-4, tells="piston_area"),
    Datum("rod", "m", "diameter of the rod on chamber B's side", "25 mm", tells="piston_area"),
    Datum("rod_a", "m",
        "diameter of the rod on chamber A's side; 0 mm for a cylinder with one rod", "0 mm", tells="piston_area"),
    Datum("stroke", "m", "whole stroke, from end to end", "200 mm", 1e-4, tells="actuator_displacement"),
    Datum("hose_bore", "m", "inner diameter of the hoses or pipes between valve and cylinder",
        "8 mm", 1e-4, tells="line_volume"),
    Datum("hose_length_a", "m", "length of the hose or pipe to chamber A", "0.5 m", tells="line_volume"),
    Datum("hose_length_b", "m", "length of the hose or pipe to chamber B", "0.5 m", tells="line_volume"),
    Datum("dead_volume", "m^3",
        "further oil at each port: manifold, fittings, the cylinder's own", "5 cm^3", tells="line_volume"),
    Datum("pump_displacement", "m^3", "oil that the pump delivers in a revolution", "10 cm^3", 1e-9,
        tells="pump_displacement"),
    Datum("supply_pressure", "Pa", "supply pressure, gauge", "210 bar", 1e4, tells="supply_pressure"),
    Datum("return_pressure", "Pa", "return pressure, gauge", "0 bar", tells="return_pressure"),
    Datum("bulk_modulus", "Pa", "effective bulk modulus of the oil with its air and the hoses",
        "1.2 GPa", 1e6, tells="bulk_modulus"),
    Datum("moving_mass", "kg", "mass of piston, rod and load", "24 kg", 1e-3, tells="moving_mass"),
    Datum("damping", "N s/m", "viscous damping of piston and load", "2000 Ns/m", tells="damping_coefficient"),
    Datum("spring_stiffness", "N/m", "stiffness of a spring that the load works against",
        "0 N/m", tells="spring_stiffness"),
    Datum("leakage_flow", "m^3/s", "leakage across the piston, measured or of the seals",
        "10 ml/min", tells="internal_leakage"),
    Datum("leakage_pressure", "Pa", "pressure difference at that leakage", "100 bar", 1e3, tells="internal_leakage"),
)  # fmt: skip
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")


def quantity(datum: Datum, text: str) -> float:
    """The value of a line as a person writes it, such as `40 mm`, in SI units.

    Raises:
        ParameterError: it is not a number with a unit of that quantity, or no value that makes sense.
    """
    option = f"--{datum.name.replace('_', '-')}"
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        raise ParameterError(f"{option} {text!r} is not a number with a unit; write for example {datum.example!r}")
    value, name = float(match[1]), match[2].strip()
    fitting = [unit for unit, row in UNITS.items() if row.si == datum.si]
    if datum.si == "":
        if name:
            raise ParameterError(f"{option} {text!r} has no unit; write for example {datum.example}")
    elif not name and value != 0.0:
        raise ParameterError(f"{option} {text}: in which unit? write for example {datum.example!r}")
    elif name:
        unit = unit_named(name)
        if unit is None or unit.si != datum.si:
            raise ParameterError(f"{option} {text!r}: {name} is not a unit of it; {remedy(name, fitting)}")
        value *= unit.scale
    if not isfinite(value) or value < datum.least:
        raise ParameterError(f"{option} {text!r} is less than any rig's; write for example {datum.example!r}")
    return value
