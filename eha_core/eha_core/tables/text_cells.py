"""Cells of text tables as numbers, dates and times of day."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_DATE = re.compile(
    r"(?:(?P<iso>\d{4}[-/]\d{2}[-/]\d{2})|(?P<day>\d{2})\.(?P<month>\d{2})\.(?P<year>\d{4}))?"
    r"(?:(?:^|[T ]|(?<=\d) )(?P<clock>\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?))\s*(?P<zone>Z|UTC|[+-]\d{2}:?\d{2})?"
)
"""2024-05-01T12:00:00.123Z, 2024/05/01 12:00:00, 01.05.2024 12:00:00,123 and 12:00:00.123."""


def number(cell: str) -> float:
    """The number of a cell; NaN where it holds none."""
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def is_number(cell: str) -> bool:
    """Whether a cell holds a number, NaN being none."""
    return not np.isnan(number(cell))


def is_date(cell: str) -> bool:
    """Whether a cell holds a date with a time of day, or a time of day."""
    return _DATE.fullmatch(cell.strip()) is not None


def nanoseconds(cells: Sequence[str]) -> NDArray[np.int64]:
    """Dates as ns since 1970 in the zone that they name, times of day as ns since midnight; zero for other cells."""
    instants = [_instant(cell) for cell in cells]
    known = np.array([text for text, _ in instants], dtype="datetime64[ns]").astype(np.int64)
    offsets = np.array([minutes for _, minutes in instants], dtype=np.int64)
    return np.asarray(known - offsets * 60_000_000_000)


def _instant(cell: str) -> tuple[str, int]:
    """The text that numpy reads as an instant, and how many minutes its zone is ahead."""
    match = _DATE.fullmatch(cell.strip())
    if match is None:
        return "1970-01-01", 0
    day = f"{match['year']}-{match['month']}-{match['day']}" if match["year"] else match["iso"] or "1970-01-01"
    clock = match["clock"].replace(",", ".")
    whole, _, fraction = clock.rjust(len(clock) + (clock.index(":") < 2), "0").partition(".")
    zone = match["zone"] or ""
    minutes = 0
    if zone[:1] in ("+", "-"):
        minutes = (60 * int(zone[1:3]) + int(zone[-2:])) * (-1 if zone[0] == "-" else 1)
    text = f"{day.replace('/', '-')}T{whole}.{fraction[:9] or '0'}"
    try:
        np.datetime64(text, "ns")
    except ValueError:
        return "1970-01-01", 0
    return text, minutes
