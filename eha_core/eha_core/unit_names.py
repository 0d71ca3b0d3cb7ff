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
_GALLON = 3.785411784e-3  # US gallon, 231 cubic inches

UNITS: dict[str, Unit] = {
    "s": Unit("s", 1.0), "ms": Unit("s", 1e-3), "us": Unit("s", 1e-6), "ns": Unit("s", 1e-9), "min": Unit("s", 60.0),
    "V": Unit("V", 1.0), "mV": Unit("V", 1e-3),
    "A": Unit("A", 1.0), "mA": Unit("A", 1e-3), "uA": Unit("A", 1e-6),
    "m": Unit("m", 1.0), "mm": Unit("m", 1e-3), "cm": Unit("m", 1e-2), "um": Unit("m", 1e-6), "in": Unit("m", 0.0254),
    "m/s": Unit("m/s", 1.0), "mm/s": Unit("m/s", 1e-3), "cm/s": Unit("m/s", 1e-2), "in/s": Unit("m/s", 0.0254),
    "Pa": Unit("Pa", 1.0), "bar": Unit("Pa", 1e5), "MPa": Unit("Pa", 1e6), "kPa": Unit("Pa", 1e3),
    "psi": Unit("Pa", _PSI), "mbar": Unit("Pa", 1e2),
    "barg": Unit("Pa", 1e5, "gauge"), "bara": Unit("Pa", 1e5, "absolute"),
    "psig": Unit("Pa", _PSI, "gauge"), "psia": Unit("Pa", _PSI, "absolute"),
    "N": Unit("N", 1.0), "kN": Unit("N", 1e3), "lbf": Unit("N", 4.4482216152605),
    "m^3/s": Unit("m^3/s", 1.0), "l/min": Unit("m^3/s", 1e-3 / 60.0), "l/s": Unit("m^3/s", 1e-3),
    "ml/min": Unit("m^3/s", 1e-6 / 60.0), "cm^3/s": Unit("m^3/s", 1e-6), "gpm": Unit("m^3/s", _GALLON / 60.0),
    "kg": Unit("kg", 1.0), "t": Unit("kg", 1e3), "lb": Unit("kg", 0.45359237),
    "m^3": Unit("m^3", 1.0), "l": Unit("m^3", 1e-3), "cm^3": Unit("m^3", 1e-6), "ml": Unit("m^3", 1e-6),
    "rad/s": Unit("rad/s", 1.0), "Hz": Unit("rad/s", 2.0 * pi), "rpm": Unit("rad/s", 2.0 * pi / 60.0),
    "deg/s": Unit("rad/s", pi / 180.0),
    "ohm": Unit("ohm", 1.0), "kohm": Unit("ohm", 1e3), "henry": Unit("H", 1.0), "mH": Unit("H", 1e-3),
    "N/m": Unit("N/m", 1.0), "N/mm": Unit("N/m", 1e3), "Ns/m": Unit("N s/m", 1.0), "GPa": Unit("Pa", 1e9),
}  # fmt: skip
"""What a topics file's `unit`, or a value of a data sheet, may be in."""

_ALSO = {
    "1/min": "rpm", "min^-1": "rpm", "u/min": "rpm",
    "\u03c9": "ohm", "ohms": "ohm", "n s/m": "Ns/m", "n*s/m": "Ns/m", "cc": "cm^3", "cm3": "cm^3", "m3": "m^3",
    "sec": "s", "second": "s", "seconds": "s", "msec": "ms", "millisecond": "ms", "milliseconds": "ms", "usec": "us",
    "microseconds": "us", "nsec": "ns", "nanoseconds": "ns", "volt": "V", "volts": "V", "amp": "A", "amps": "A",
    "ampere": "A", "meter": "m", "metre": "m", "meters": "m", "metres": "m", "inch": "in", "pascal": "Pa",
    "newton": "N", "newtons": "N", "bar(g)": "barg", "bar(a)": "bara", "bar_g": "barg", "bar_a": "bara",
    "bar(abs)": "bara", "bar abs": "bara", "bar rel": "barg", "lpm": "l/min", "l/m": "l/min", "ltr/min": "l/min",
    "m3/s": "m^3/s", "cm3/s": "cm^3/s", "ccm/s": "cm^3/s", "usgpm": "gpm", "mps": "m/s", "mmps": "mm/s",
}  # fmt: skip
_LOWER = {name.lower(): name for name in UNITS}
_AMBIGUOUS = ("mPa", "MPA", "MV", "MA")
"""Milli or mega: in capitals nothing tells, and nobody means a millipascal."""


def unit_named(text: str) -> Unit | None:
    """The unit that a logger calls so; None where it is none of those known here."""
    name = text.strip().replace("µ", "u").replace("μ", "u").replace("³", "^3").replace("²", "^2")
    if name in UNITS:
        return UNITS[name]
    if name in _AMBIGUOUS:
        return None
    lower = name.lower()
    known = _ALSO.get(lower) or _LOWER.get(lower)
    return UNITS[known] if known else None


def name_of(unit: Unit) -> str:
    """The name of a unit in a topics file; its reference is a key of its own there."""
    return next(name for name, known in UNITS.items() if (known.si, known.scale) == (unit.si, unit.scale))
