"""Suggests which column of a table is its time, and in which unit: certain, or as a question."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

from eha_core.recording.column_names import words_of
from eha_core.recording.field_meanings import meant
from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.name_words import INDEX
from eha_core.recording.readings import Reading
from eha_core.recording.time_units import FASTEST, time_unit
from eha_core.unit_names import UNITS, unit_named

_ROWS = "how many samples a second? the file has no times"


@dataclass(frozen=True)
class TimeQuestion:
    """The question about a table's time: its text, and the possible answers, the likely one first."""

    text: str
    readings: tuple[Reading, ...]


def suggest_time(inspection: Inspection, fields: Sequence[Field]) -> list[Reading | TimeQuestion]:
    """A table's time; empty where each column has its own, or a stated rate gives the times."""
    own = {field.time for field in fields if field.time}
    if own:
        return _own_times(fields, own)
    rate = inspection.rate
    named = [field for field in fields if _is_time(field)]
    moving = [field for field in named if field.step > 0.0 and field.repeated == 0.0]
    indices = [field for field in fields if _is_index(field)]
    standing = [field for field in named if field.repeated > 0.0]
    # A date is better than a count of ms, and both are better than a sample number.
    for field in sorted(moving, key=lambda one: (one.unit != "ns", one.unit == "", fields.index(one))):
        found = _of_times(field, rate)
        if isinstance(found, Reading):
            return [found]
    if rate is not None:
        index = next(iter([field for field in (*indices, *moving) if _counts(field)]), None)
        if index is not None or not moving:
            return [] if index is None else [Reading("time", index, rate=rate)]
    if moving:
        return [_of_times(moving[0], rate)] if len(moving) == 1 else [_which(moving)]
    if standing:
        return [_of_standing(standing[0])]
    if indices:
        text = f'"{indices[0].path}": it counts samples: how many in a second?'
        return [TimeQuestion(text, (Reading("time", indices[0], rate=nan),))]
    rising = [field for field in fields if field.step > 0.0 and _may_be_time(field)]
    if rising:
        certain = [one for field in rising if isinstance(one := _of_times(field, None), Reading)]
        if (
            len(certain) == 1
            and (len(rising) == 1 or certain[0].field is fields[0])
            and (unit_named(certain[0].field.unit) is not None or certain[0].field is fields[0])
        ):
            return [certain[0]]
        return [_which(rising)]
    return [TimeQuestion(_ROWS, (Reading("time", Field("", "", 0, nan, nan, nan, ""), rate=nan),))]


def _own_times(fields: Sequence[Field], own: set[str]) -> list[Reading | TimeQuestion]:
    """The readings of the columns' own times, or questions about them."""
    clocks = [field for field in fields if field.path in own]
    open_clocks = [one for field in clocks if isinstance(one := _of_times(field, None), TimeQuestion)]
    return [open_clocks[0]] if open_clocks else []


def _is_time(field: Field) -> bool:
    """Whether a field is named a time, or has a unit of time."""
    unit = unit_named(field.unit)
    if unit is not None and unit.si != "s":
        return False
    named = meant(field).meaning.channels == {"time"}
    return named or (unit is not None and not meant(field).meaning.channels and not meant(field).meaning.is_other)


def _may_be_time(field: Field) -> bool:
    unit = unit_named(field.unit)
    return (unit is None and not field.unit or unit is not None and unit.si == "s") and not meant(
        field
    ).meaning.is_other


def _is_index(field: Field) -> bool:
    """Whether a field numbers the rows: named so, and increasing by whole steps."""
    words = [word for word in words_of(field.path) if not word.isdigit()] or (
        ["n"] if field.path.strip() == "#" else []
    )
    return (
        bool(set(words) & INDEX) and all(word in INDEX or word in ("time", "of") for word in words) and _counts(field)
    )


def _counts(field: Field) -> bool:
    return field.step >= 1.0 and field.step == int(field.step) and field.first == int(field.first) and not field.unit


def _of_times(field: Field, rate: float | None) -> Reading | TimeQuestion:
    if field.day_first is not None:
        orders = (field.day_first, not field.day_first)
        text = (
            f'"{field.path}": does the day or the month stand first? both fit, and the record is shorter with the first'
        )
        return TimeQuestion(
            text, tuple(Reading("time", field, "ns", day_first=one, is_certain=False) for one in orders)
        )
    found = time_unit(field.first, field.step, field.unit, rate)
    if found.is_certain and not (_is_index(field) and not field.unit):
        return Reading("time", field, found.units[0], assumed="")
    if rate is not None and _counts(field) and not found.is_certain:
        return Reading("time", field, rate=rate)
    readings = [Reading("time", field, unit, is_certain=False) for unit in found.units]
    if _counts(field) and field.step == 1.0 and field.first in (0.0, 1.0) and not _is_time(field):
        readings = []  # an index without a name
    if _counts(field):
        readings.append(Reading("time", field, rate=nan, is_certain=False))
    step = f"it goes by steps of {field.step:.4g}{' ' + field.unit if field.unit else ''}"
    fast = ""
    unit = unit_named(field.unit)
    if unit is not None and unit.si == "s" and 1.0 / (field.step * unit.scale) > FASTEST:
        fast = ", which is faster than any rig is recorded"
    states = f"; the file states {rate:g} Hz" if rate is not None else ""
    return TimeQuestion(f'"{field.path}": in which unit is time? {step}{fast}{states}', tuple(readings))


def _of_standing(field: Field) -> TimeQuestion:
    """The question about times that are coarser than the samples."""
    unit = unit_named(field.unit)
    rate = field.repeated / (unit.scale if unit is not None and unit.si == "s" else UNITS["s"].scale)
    text = f'"{field.path}": several rows have the same time; are there {rate:.6g} rows in a second?'
    return TimeQuestion(text, (Reading("time", field, rate=float(f"{rate:.4g}"), is_certain=False),))


def _which(fields: Sequence[Field]) -> TimeQuestion:
    readings: list[Reading] = []
    for field in fields:
        found = _of_times(field, None)
        readings += [found] if isinstance(found, Reading) else found.readings
    names = ", ".join(f'"{field.path}"' for field in fields)
    return TimeQuestion(f"{names}: which of these is time?", tuple(readings))
