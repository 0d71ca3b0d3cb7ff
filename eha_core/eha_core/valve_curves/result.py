"""What was measured and what was found of it, as frozen facts; the report writes the sentences."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FLOW, PRESSURE, LEAKAGE = "flow", "pressure gain", "leakage"
"""The kinds of curves: control flow at constant valve pressure drop, load pressure at blocked ports, and the supply's
flow at blocked ports; each over the command (terms of ISO 10770-1)."""

RESPONSE_UNITS = {FLOW: "m^3/s", PRESSURE: "Pa", LEAKAGE: "m^3/s"}


@dataclass(frozen=True)
class Curve:
    """One steady curve as measured, in the order of its rows.

    Attributes:
        source: the file's name.
        kind: FLOW, PRESSURE or LEAKAGE.
        command: current [A], voltage [V] or share of the full command [%].
        unit: the command's unit, "A", "V" or "%".
        response: flow [m^3/s] or load pressure [Pa].
        remarks: rows left out and the like.
    """

    source: str
    kind: str
    command: Array
    unit: str
    response: Array
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Conditions:
    """What the columns do not say.

    Attributes:
        pressure_drop: over both edges of the valve during the flow curve: supply less return less load [Pa].
        supply_pressure: at blocked ports, above the return line's [Pa].
        rated_current: coil current at the full command [A].
        rated_voltage: the full command [V], of a curve over voltage.
    """

    pressure_drop: float | None = None
    supply_pressure: float | None = None
    rated_current: float | None = None
    rated_voltage: float | None = None


@dataclass(frozen=True)
class Value:
    """One figure of a curve: its name, value and half of its 95 % interval [unit]; `reach` None without an interval."""

    name: str
    value: float
    reach: float | None
    unit: str

    @property
    def is_sure(self) -> bool:
        """Whether zero lies outside of the interval."""
        return self.reach is not None and bool(abs(self.value) > self.reach)


@dataclass(frozen=True)
class CurveFit:
    """A curve with its figures.

    Attributes:
        values: the figures by name.
        lines: fitted lines to draw: a label, commands and responses.
        remarks: what was assumed, and what the curve cannot show.
    """

    curve: Curve
    values: dict[str, Value]
    lines: tuple[tuple[str, Array, Array], ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Found:
    """A parameter of the plant that a curve gives: its full name, value, half of its 95 % interval [unit], and how."""

    name: str
    value: float
    reach: float
    unit: str
    how: str
    is_sure: bool


@dataclass(frozen=True)
class ValveCurves:
    """All curves of one valve.

    Attributes:
        fits: each curve with its figures.
        conditions: those of the test.
        parameters: the plant's parameters that follow.
        left_out: parameters of the plant that do not follow, each with the reason and the remedy.
    """

    fits: tuple[CurveFit, ...]
    conditions: Conditions
    parameters: tuple[Found, ...] = ()
    left_out: dict[str, str] = field(default_factory=dict)
