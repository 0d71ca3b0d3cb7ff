"""Units by the names that loggers and data sheets write, with what makes SI of them."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class Unit:
    """A unit: of which SI unit it is `scale` times, and, for pressures that say so, whether they are gauge."""

    si: str
    scale: float
    reference: str | None = None


_PSI = 6894.757293168  # 0.45359237 kg x 9.80665 m/s^2 over a square inch
_KILOPOND = 9.80665  # N; the weight of a kilogram
_GALLON = 3.785411784e-3  # US gallon, 231 cubic inches

UNITS: dict[str, Unit] = {
    "s": Unit("s", 1.0), "ms": Unit("s", 1e-3), "us": Unit("s", 1e-6), "ns": Unit("s", 1e-9), "min": Unit("s", 60.0),
    "100ns": Unit("s", 1e-7), "h": Unit("s", 3600.0), "day": Unit("s", 86400.0),
    "V": Unit("V", 1.0), "mV": Unit("V", 1e-3),
    "A": Unit("A", 1.0), "mA": Unit("A", 1e-3), "uA": Unit("A", 1e-6),
    "m": Unit("m", 1.0), "mm": Unit("m", 1e-3), "cm": Unit("m", 1e-2), "um": Unit("m", 1e-6), "in": Unit("m", 0.0254),
    "m/s": Unit("m/s", 1.0), "mm/s": Unit("m/s", 1e-3), "cm/s": Unit("m/s", 1e-2), "in/s": Unit("m/s", 0.0254),
    "Pa": Unit("Pa", 1.0), "bar": Unit("Pa", 1e5), "MPa": Unit("Pa", 1e6), "kPa": Unit("Pa", 1e3),
    "psi": Unit("Pa", _PSI), "mbar": Unit("Pa", 1e2), "kgf/cm^2": Unit("Pa", _KILOPOND * 1e4),
    "barg": Unit("Pa", 1e5, "gauge"), "bara": Unit("Pa", 1e5, "absolute"),
    "psig": Unit("Pa", _PSI, "gauge"), "psia": Unit("Pa", _PSI, "absolute"),
    "N": Unit("N", 1.0), "kN": Unit("N", 1e3), "daN": Unit("N", 10.0), "lbf": Unit("N", 4.4482216152605),
    "kgf": Unit("N", _KILOPOND),
    "m^3/s": Unit("m^3/s", 1.0), "l/min": Unit("m^3/s", 1e-3 / 60.0), "l/s": Unit("m^3/s", 1e-3),
    "ml/min": Unit("m^3/s", 1e-6 / 60.0), "cm^3/s": Unit("m^3/s", 1e-6), "gpm": Unit("m^3/s", _GALLON / 60.0),
    "m^3/h": Unit("m^3/s", 1.0 / 3600.0),
    "kg": Unit("kg", 1.0), "t": Unit("kg", 1e3), "lb": Unit("kg", 0.45359237),
    "m^3": Unit("m^3", 1.0), "l": Unit("m^3", 1e-3), "cm^3": Unit("m^3", 1e-6), "ml": Unit("m^3", 1e-6),
    "rad/s": Unit("rad/s", 1.0), "Hz": Unit("rad/s", 2.0 * pi), "rpm": Unit("rad/s", 2.0 * pi / 60.0),
    "deg/s": Unit("rad/s", pi / 180.0),
    "ohm": Unit("ohm", 1.0), "kohm": Unit("ohm", 1e3), "henry": Unit("H", 1.0), "mH": Unit("H", 1e-3),
    "N/m": Unit("N/m", 1.0), "N/mm": Unit("N/m", 1e3), "Ns/m": Unit("N s/m", 1.0), "GPa": Unit("Pa", 1e9),
    "rad": Unit("rad", 1.0), "deg": Unit("rad", pi / 180.0), "Nm": Unit("N m", 1.0), "kNm": Unit("N m", 1e3),
    "%": Unit("%", 1.0), "permille": Unit("%", 0.1), "counts": Unit("counts", 1.0),
    "m/s^2": Unit("m/s^2", 1.0), "K": Unit("K", 1.0), "degC": Unit("K", 1.0), "degF": Unit("K", 5.0 / 9.0),
    "W": Unit("W", 1.0), "kW": Unit("W", 1e3),
}  # fmt: skip
"""What a column may be in; a topics file's `unit` and a value of a data sheet are those of their quantity."""

_ALSO = {
    "s": "sec second seconds sek sekunde sekunden", "ms": "msec msecs millisecond milliseconds millisekunden",
    "us": "usec usecs microsecond microseconds", "ns": "nsec nanosecond nanoseconds", "min": "minute minutes minuten",
    "h": "hour hours", "day": "days d", "100ns": "filetime",
    "V": "volt volts vdc", "A": "amp amps ampere amperes", "mA": "milliamp milliamps",
    "m": "meter metre meters metres", "mm": "millimeter millimetre millimeters millimetres", "um": "micron microns",
    "in": "inch inches", "m/s": "mps m_s", "mm/s": "mmps", "in/s": "ips",
    "Pa": "pascal", "bar": "bars", "barg": "bar(g) bar_g bar|rel bar|g bar(gauge)",
    "bara": "bar(a) bar_a bar(abs) bar|abs barabs bar|a", "psi": "lbf/in^2 lb/in^2",
    "kgf/cm^2": "kgf/cm2 kp/cm^2 kp/cm2 kg/cm^2 kg/cm2 at", "permille": "\u2030 promille",
    "N": "newton newtons", "lbf": "lbs", "kgf": "kp",
    "l/min": "lpm l/m ltr/min lit/min dm^3/min liter/min litre/min", "m^3/s": "m3/s", "cm^3/s": "cm3/s ccm/s cc/s",
    "ml/min": "cm^3/min cc/min", "gpm": "usgpm gal/min", "cm^3": "cc cm3", "m^3": "m3",
    "rpm": "1/min min^-1 u/min rev/min r/min", "ohm": "\u03c9 ohms", "Ns/m": "n|s/m n*s/m",
    "rad": "radian radians", "deg": "\u00b0 degree degrees grad", "Nm": "n*m n|m n-m", "rad/s": "rads rad/sec",
    "deg/s": "\u00b0/s", "%": "percent pct prozent %fs %|fs", "m/s^2": "m/s2",
    "degC": "\u00b0c celsius", "degF": "\u00b0f",
    "counts": "count cts digit digits lsb inc incr increments inkremente pulse pulses ticks bits adc raw",
}  # fmt: skip
"""What else loggers write for a unit, in small letters, | for a blank."""
_BY_ALIAS = {alias.replace("|", " "): unit for unit, aliases in _ALSO.items() for alias in aliases.split()}
_LOWER = {name.lower(): name for name in UNITS}
_AMBIGUOUS = ("mPa", "MPA", "MV", "MA", "nm")
"""Milli or mega: in capitals nothing tells, and nobody means a millipascal; nm may be a length or a torque."""


def unit_named(text: str) -> Unit | None:
    """The unit that a logger calls so; None where it is none of those known here."""
    name = text.strip().replace("\u00b5", "u").replace("\u03bc", "u").replace("\u00b3", "^3").replace("\u00b2", "^2")
    if name in UNITS:
        return UNITS[name]
    if name in _AMBIGUOUS:
        return None
    lower = name.lower()
    known = _BY_ALIAS.get(lower) or _LOWER.get(lower)
    return UNITS[known] if known else None


def name_of(unit: Unit) -> str:
    """The name of a unit in a topics file; its reference is a key of its own there."""
    return next(name for name, known in UNITS.items() if (known.si, known.scale) == (unit.si, unit.scale))
