"""The unit of a column of times: a table of the forms in which loggers write times, and one rule to choose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.tables import Column
from eha_core.unit_names import UNITS, unit_named

LONGEST_STEP = 1.0
"""s; longest sampling period: a slower recording does not show an actuator's dynamics, so the unit is another."""
FASTEST = 5e4
"""Hz; highest sampling rate: no logger samples a rig's pressures faster, so the unit is another."""
ONLY_NS = 1e6
"""Step from which a count is in ns: in us it would be slower than LONGEST_STEP."""
AGREES = 0.05
"""Relative difference allowed between a stated rate and that of the times: clocks are better, but rates are rounded."""
MOST_REPEATED = 0.2
"""Largest share of repeated times: a late logger occasionally writes two rows at once."""
_WRAPS_WITHIN = 3.0
"""Steps by which a counter may miss its period where it wraps."""
_MOST_WRAPS = 0.1
"""Largest share of backward steps in a counter that wraps."""


@dataclass(frozen=True)
class TimeForm:
    """A way to write times: its unit, the range of values of the years 2001 to 2096, and the epoch."""

    unit: str
    low: float
    high: float
    since: str


FORMS: tuple[TimeForm, ...] = (
    TimeForm("ms", 1e12, 4e12, "1970"),
    TimeForm("us", 1e15, 4e15, "1970"),
    TimeForm("ns", 1e18, 4e18, "1970"),
    TimeForm("100ns", 1.26e17, 1.565e17, "1601, as Windows counts"),
    TimeForm("100ns", 6.31e17, 6.62e17, "the year 1, as .NET counts"),
    TimeForm("day", 36_892.0, 71_956.0, "1900, as spreadsheets count"),
    TimeForm("day", 730_852.0, 765_916.0, "the year 0, as MATLAB counts"),
    TimeForm("day", 2_451_910.0, 2_486_975.0, "the Julian epoch"),
)
"""Times in s since any epoch, Unix and GPS alike, need no entry: their steps are less than a second."""
_PERIODS = (
    *(2.0**bits for bits in (8, 15, 16, 31, 32)), *(2.0**32 * scale for scale in (1e-3, 1e-6)), 2.0**16 * 1e-3,
    60.0, 1e3, 3600.0, 43_200.0, 86_400.0, 1e6, 86_400e3, 86_400e6, 3600e9, 43_200e9, 86_400e9, 604_800.0,
)  # fmt: skip
"""Periods after which counters wrap: at whole bytes, also of ms and us in s; clocks at the minute, hour, noon,
midnight."""


@dataclass(frozen=True)
class TimeUnit:
    """The possible units of times.

    Attributes:
        units: the possible units, the likely one first.
        is_certain: whether the first is certain.
        why: the reason, where the file does not state the unit.
    """

    units: tuple[str, ...]
    is_certain: bool
    why: str = ""


def time_unit(first: float, step: float, stated: str = "", rate: float | None = None) -> TimeUnit:
    """The unit of times, from the file's statement, their first value and their step.

    Args:
        first: the first time.
        step: the usual step; zero where the times repeat.
        stated: the unit that the file states; empty for none.
        rate: the rate that the file states [Hz]; None for none.
    """
    unit = unit_named(stated)
    name = next((one for one, known in UNITS.items() if known == unit), "") if unit and unit.si == "s" else ""
    form = next(
        (one for one in FORMS if one.low <= abs(first) < one.high and (one.unit != "day" or step * 86400.0 < 1.0)), None
    )
    if form is not None and name in ("", form.unit):
        return TimeUnit((form.unit,), True, "" if name == "ns" else f"{form.unit} since {form.since}")
    if name:
        others = tuple(other for other in _plausible(step) if other != name)
        if step > 0.0 and 1.0 / (step * UNITS[name].scale) > FASTEST:
            return TimeUnit((*others, name), False)
        if rate is not None and step > 0.0 and not _agree(rate, step, name):
            return TimeUnit((*(other for other in others if _agree(rate, step, other)), name), False)
        return TimeUnit((name,), True, "" if name in ("s", "ns") else f"{stated}, as the file says")
    if rate is not None and step > 0.0:
        fitting = [other for other in ("s", "ms", "us", "ns", "min", "h", "day") if _agree(rate, step, other)]
        if fitting:
            return TimeUnit(
                (fitting[0],),
                True,
                "" if fitting[0] == "s" else f"{fitting[0]}, as the stated rate of {rate:g} Hz says",
            )
    if 1.0 / FASTEST <= step < LONGEST_STEP:
        return TimeUnit(("s",), True)
    if step >= ONLY_NS:
        return TimeUnit(("ns",), True, "ns")
    return TimeUnit(_plausible(step) or ("s", "ms", "us", "ns"), False)


def _agree(rate: float, step: float, unit: str) -> bool:
    return abs(1.0 / (rate * step * UNITS[unit].scale) - 1.0) <= AGREES


def _plausible(step: float) -> tuple[str, ...]:
    """Units in which a step is plausible for a recording of an actuator."""
    units = ("s", "ms", "us", "100ns", "ns", "min", "h", "day")
    return tuple(one for one in units if step > 0.0 and 1.0 / FASTEST <= step * UNITS[one].scale < LONGEST_STEP)


def usual_step(times: Column) -> float:
    """The usual step of times that never decrease; zero for others, and where most repeat."""
    # Integers are compared as they are: ns since 1970 exceed a float's resolution.
    with np.errstate(over="ignore"):
        steps = np.diff(times).astype(np.float64)
    return float(np.median(steps)) if len(steps) and np.all(steps >= 0.0) and steps.any() else 0.0


def repeats(times: Column) -> bool:
    """Whether times often repeat and never decrease: a clock coarser than the samples."""
    with np.errstate(over="ignore"):
        steps = np.diff(times).astype(np.float64)
    return bool(len(steps) > 2 and np.all(steps >= 0.0) and steps.any() and np.mean(steps == 0.0) > MOST_REPEATED)


def unwrapped(times: Column) -> tuple[Column, str]:
    """Times continued where a counter or a clock wrapped, and a remark where one did."""
    if len(times) < 3:
        return times, ""
    with np.errstate(over="ignore"):
        steps = np.diff(times).astype(np.float64)
    back = steps < 0.0
    forward = steps[steps > 0.0]
    if not back.any() or not len(forward) or np.mean(back) > _MOST_WRAPS or float(np.min(times)) < 0.0:
        return times, ""
    step = float(np.median(forward))
    lengths = step - steps[back]
    period = next((one for one in _PERIODS if np.all(np.abs(lengths - one) <= _WRAPS_WITHIN * step)), None)
    if period is None or float(np.max(times)) > 1.1 * period:
        return times, ""
    turns = np.concatenate([[0], np.cumsum(back)])
    made = times + turns * (int(period) if times.dtype.kind == "i" else period)
    return made.astype(times.dtype), f"wraps after {period:g} and was continued there, {int(back.sum())} times"
