"""What a column of times counts: one table of the forms in which loggers write instants, and one rule to choose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.tables import Column
from eha_core.unit_names import UNITS, unit_named

LONGEST_STEP = 1.0
"""s between samples from which on a time is no second's count: so slow a recording shows no actuator's dynamics."""
FASTEST = 5e4
"""Hz; what would be recorded faster counts another unit: no logger of a rig samples its pressures so fast."""
ONLY_NS = 1e6
"""Steps from which on a count is of ns: in us it would be slower than LONGEST_STEP."""
AGREES = 0.05
"""Share by which a stated rate and that of the times may differ: loggers' clocks are better, and round their rate."""
MOST_REPEATED = 0.2
"""Share of steps in which times may stand: a logger that is late writes two rows at once now and then."""
_WRAPS_WITHIN = 3.0
"""Steps by which a counter may miss its period where it begins anew."""
_MOST_WRAPS = 0.1
"""Share of the steps that may go backwards in a counter that wraps."""


@dataclass(frozen=True)
class TimeForm:
    """A way to write instants: its unit, between which values the instants of 2001 to 2096 lie, and since when."""

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
"""Instants since any epoch in s, Unix and GPS alike, need no word: they go by steps of less than a second."""
_PERIODS = (
    *(2.0**bits for bits in (8, 15, 16, 31, 32)), *(2.0**32 * scale for scale in (1e-3, 1e-6)), 2.0**16 * 1e-3,
    60.0, 1e3, 3600.0, 43_200.0, 86_400.0, 1e6, 86_400e3, 86_400e6, 3600e9, 43_200e9, 86_400e9, 604_800.0,
)  # fmt: skip
"""Where counters begin anew: at whole bytes, of ms and us in s too; clocks at the minute, hour, noon, midnight."""


@dataclass(frozen=True)
class TimeUnit:
    """What times may be counted in.

    Attributes:
        units: the possible units, the likely one first.
        is_certain: whether the first is certain.
        why: how it is known, where the file does not state it.
    """

    units: tuple[str, ...]
    is_certain: bool
    why: str = ""


def time_unit(first: float, step: float, stated: str = "", rate: float | None = None) -> TimeUnit:
    """In which unit times are, by what the file states, how they begin and how far they go in a step.

    Args:
        first: the first time.
        step: the usual step; zero where the times stand.
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
    """Units in which a step makes a recording of an actuator."""
    units = ("s", "ms", "us", "100ns", "ns", "min", "h", "day")
    return tuple(one for one in units if step > 0.0 and 1.0 / FASTEST <= step * UNITS[one].scale < LONGEST_STEP)


def usual_step(times: Column) -> float:
    """The usual step of times that never go back; zero for others, and where most stand."""
    # Whole numbers are distinguished as they are: ns since 1970 are more than a float holds.
    with np.errstate(over="ignore"):
        steps = np.diff(times).astype(np.float64)
    return float(np.median(steps)) if len(steps) and np.all(steps >= 0.0) and steps.any() else 0.0


def repeats(times: Column) -> bool:
    """Whether times often stand and never go back: a clock coarser than the samples."""
    with np.errstate(over="ignore"):
        steps = np.diff(times).astype(np.float64)
    return bool(len(steps) > 2 and np.all(steps >= 0.0) and steps.any() and np.mean(steps == 0.0) > MOST_REPEATED)


def unwrapped(times: Column) -> tuple[Column, str]:
    """Times that go on where a counter or a clock began anew, and a remark where one did."""
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
    return made.astype(times.dtype), f"begins anew after {period:g} and was continued there, {int(back.sum())} times"
