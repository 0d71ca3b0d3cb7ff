"""Numbers for people: units of a fitting size, and no more digits than are known."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import floor, isfinite, log10

_PREFIXES = {
    "m": ((1e-6, "µm"), (1e-3, "mm"), (1.0, "m")),
    "m/s": ((1e-6, "µm/s"), (1e-3, "mm/s"), (1.0, "m/s")),
    "Pa": ((1.0, "Pa"), (1e3, "kPa"), (1e6, "MPa"), (1e9, "GPa")),
    "s": ((1e-6, "µs"), (1e-3, "ms"), (1.0, "s")),
    "A": ((1e-6, "µA"), (1e-3, "mA"), (1.0, "A")),
    "V": ((1e-6, "µV"), (1e-3, "mV"), (1.0, "V")),
    "N": ((1.0, "N"), (1e3, "kN"), (1e6, "MN")),
    "m^2": ((1e-6, "mm²"), (1e-4, "cm²"), (1.0, "m²")),
    "1/A": ((1.0, "per A"), (1e3, "per mA")),
    "N/m": ((1.0, "N/m"), (1e3, "kN/m"), (1e6, "MN/m")),
    "m^3/s": ((1e-6 / 60.0, "ml/min"), (1e-3 / 60.0, "l/min")),
    "m^3/(s Pa)": ((1e-12 / 60.0, "ml/min per MPa"), (1e-9 / 60.0, "l/min per MPa")),
    "m^3/(s Pa^0.5)": ((1e-9 / 60.0, "ml/min per √MPa"), (1e-6 / 60.0, "l/min per √MPa")),
    "m^3/(s A)": ((1.0 / 60.0, "l/min per mA"),),
    "m^3/(s V)": ((1e-3 / 60.0, "l/min per V"),),
    "m^3/(s %)": ((1e-3 / 60.0, "l/min per %"),),
    "Pa/A": ((1e8, "bar per mA"),),
    "Pa/V": ((1e5, "bar per V"),),
    "Pa/%": ((1e5, "bar per %"),),
    "Pa s/m^3": ((6e7, "kPa per l/min"), (6e10, "MPa per l/min")),
}
"""The units of an engineer's data sheet, by SI unit, each with its size in that; the smallest first."""

_ROOTS = {"m^(5/2) kg^(-1/2)": "m²√(m/kg)", "m^(7/2) kg^(-1/2)": "m³√(m/kg)"}
"""Units of what lets oil through by the root of a pressure, as they are shown."""

RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
"""Digits as superscripts, for `str.translate`."""


@dataclass(frozen=True)
class Scale:
    """How to show values of one unit: divide by `factor`, name it `unit`."""

    factor: float
    unit: str

    @property
    def suffix(self) -> str:
        """The unit with a space before it; nothing for pure numbers."""
        return f" {self.unit}" if self.unit else ""


def scale_for(unit: str, magnitude: float) -> Scale:
    """The largest unit of the family that does not exceed `magnitude` [SI]; else a power of ten where it is needed."""
    steps = _PREFIXES.get(unit)
    size = abs(magnitude) if isfinite(magnitude) else 0.0
    if steps:
        fitting = [step for step in steps if step[0] <= size * 1.0000001] or [steps[0] if size else (1.0, unit)]
        return Scale(*fitting[-1])
    plain = unit_text(unit)
    if size and not 1e-3 <= size < 1e5:
        exponent = floor(log10(size))
        return Scale(10.0**exponent, f"× 10{str(exponent).translate(RAISED)} {plain}".rstrip())
    return Scale(1.0, plain)


def unit_text(unit: str) -> str:
    """A unit with whole powers raised: m^3/(s Pa) as m³/(s Pa); nothing for the unit of pure numbers."""
    if unit in _ROOTS:
        return _ROOTS[unit]
    return "" if unit == "-" else re.sub(r"\^(-?\d+)", lambda power: power[1].translate(RAISED), unit)


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """A value with its unit, to that many digits: quantity(1.02e-5, "m") is "10.2 µm"."""
    if not isfinite(value):
        return "not known"
    scale = scale_for(unit, value)
    return f"{_rounded(value / scale.factor, digits)}{scale.suffix}"


@dataclass(frozen=True)
class Quantity:
    """A value in SI that a format string shows in readable units: "{}" with three digits, "{:4}" with four, "{:%}" as
    percent; "{:+}", "{:+4}" and "{:+%}" with its sign. `bound` says of which side the value is one: "at least "."""

    value: float
    unit: str
    bound: str = ""

    def __format__(self, spec: str) -> str:
        digits = spec.removeprefix("+")
        if digits == "%":
            shown = f"{_rounded(100.0 * self.value, 3)} %"
        else:
            # a bound is found to some per cent
            shown = quantity(self.value, self.unit, 3 if self.bound else int(digits or 3))
        sign = "+" if spec.startswith("+") and self.value > 0.0 else ""
        return f"{self.bound}{sign}{shown}"


def with_deviation(value: float, deviation: float, unit: str) -> str:
    """A value and its standard deviation, digits as the deviation deserves: "312.4 ± 3.9 N"."""
    if not (isfinite(deviation) and deviation > 0.0 and isfinite(value)):
        return quantity(value, unit)
    scale = scale_for(unit, max(abs(value), deviation))
    decimals = max(0, 1 - floor(log10(deviation / scale.factor)))
    if decimals > 6:
        return quantity(value, unit, 7)
    return _in_unit(f"{value / scale.factor:.{decimals}f} ± {deviation / scale.factor:.{decimals}f}", scale)


def interval(value: float, deviation: float, unit: str, sure: float = 1.96) -> str:
    """Both ends of a 95 % interval, with digits as the deviation deserves: "312.37 to 313.27 N"."""
    if not (isfinite(deviation) and deviation > 0.0 and isfinite(value)):
        return "not known"
    scale, decimals = _resolution(value, deviation, unit)
    low, high = ((value + side * sure * deviation) / scale.factor for side in (-1.0, 1.0))
    return _in_unit(f"{low:.{decimals}f} to {high:.{decimals}f}", scale)


def within(value: float, deviation: float, unit: str, sure: float = 1.96) -> str:
    """A value with half its 95 % interval: "312.82 ± 0.45 N"."""
    return with_deviation(value, sure * deviation, unit)


def bounds(low: float | None, high: float | None, unit: str) -> str:
    """An interval of which one end may not be known: "at least 17.0 kN", "at most 3.1 ms", "1.2 kN to 40.1 kN"."""
    if low is not None and high is not None:
        return f"{quantity(low, unit)} to {quantity(high, unit)}"
    if low is not None:
        return f"at least {quantity(low, unit)}"
    return f"at most {quantity(high, unit)}" if high is not None else "of any size"


def _resolution(value: float, deviation: float, unit: str) -> tuple[Scale, int]:
    """The scale of a value, and the decimals in it that its deviation leaves worth showing."""
    scale = scale_for(unit, max(abs(value), deviation))
    return scale, min(6, max(0, 1 - floor(log10(deviation / scale.factor))))


def _in_unit(numbers: str, scale: Scale) -> str:
    return f"({numbers}) {scale.unit}" if scale.unit.startswith("×") else f"{numbers}{scale.suffix}"


def short(value: float) -> str:
    """Three digits, or more before the point, without an exponent."""
    return f"{value:,.0f}" if abs(value) >= 1000.0 else _rounded(value, 3)


def _rounded(value: float, digits: int) -> str:
    if value == 0.0 or not isfinite(value):
        return "0" if value == 0.0 else "-"
    size = float(f"{abs(value):.{digits - 1}e}")  # rounded first, so that 9.997 is shown as 10.0 and not as 10.00
    return f"{value:.{max(0, digits - 1 - floor(log10(size)))}f}"
