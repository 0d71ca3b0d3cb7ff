"""Finds the format of a text table: the lines before the numbers, the delimiter and the decimal point."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from eha_core.errors import RecordingError
from eha_core.tables.long_form import LongForm, long_form_of
from eha_core.tables.number_cells import COMMA, POINT, is_grouped, is_missing, number_of
from eha_core.tables.stated import rate_in, unit_in
from eha_core.tables.table import MOST_COLUMNS
from eha_core.tables.time_cells import is_instant
from eha_core.unit_names import unit_named

SPACES = " "
"""Delimiter of any number of blanks between cells."""
DELIMITERS = ("\t", ";", ",", "|", SPACES)
_LOOKED_AT = 400
"""Rows that decide a table's format."""
_ALIKE = 5
"""Rows in the same format where the numbers begin: a header's line may have numbers, too."""
NAME_LABELS = (
    "name",
    "names",
    "channel",
    "channels",
    "channel name",
    "signal",
    "signals",
    "signal name",
    "kanal",
    "tag",
)
UNIT_LABELS = ("unit", "units", "trace_units", "einheit", "einheiten", "channel units", "unit name")
"""First cells, in small letters, of rows with the columns' names and units."""
_TYPE_NAMES = (
    "real lreal double float float32 float64 single int int16 int32 int64 uint uint16 uint32 dint udint bool number"
    " numeric string long word dword analog digital"
)


_Score = tuple[float, bool, int]
"""How well a format fits: the share of values in a row, whether a delimiter divides the cells, their number."""


@dataclass(frozen=True)
class Header:
    """The format of a text table.

    Attributes:
        kind: "csv" or "lvm".
        names: the columns' names; made up where the file has none.
        units: units by name, where the file states them.
        delimiter: between the cells; SPACES for any blanks.
        decimal: the decimal point, "." or ",".
        first: line of the file at which the numbers begin, from 0.
        skip: cells at the beginning of each row that belong to no column.
        step: first value and spacing of the first column, where its cells are empty.
        times: the column of a column's own times, by name.
        rate: rows per second that the lines above the numbers state [Hz].
        long: the columns of names and values, where a row has one value of one signal.
    """

    kind: str
    names: list[str]
    delimiter: str
    decimal: str
    first: int
    units: dict[str, str] = field(default_factory=dict)
    skip: int = 0
    step: tuple[float, float] | None = None
    times: Mapping[str, str] = field(default_factory=dict)
    rate: float | None = None
    long: LongForm | None = None


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without blanks around them."""
    if delimiter == SPACES:
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]
    except csv.Error:
        return []


def plain_header(where: str, lines: Sequence[str]) -> Header:
    """The header of a table without a vendor's layout.

    Raises:
        RecordingError: no row of numbers is among the lines, or the numbers' format is ambiguous.
    """
    found: dict[tuple[str, str], tuple[_Score, Header]] = {}
    for delimiter in DELIMITERS:
        for decimal in (POINT, COMMA):
            if (delimiter, decimal) == (",", COMMA) and not any('"' in line for line in lines):
                continue
            if (made := _written(lines, delimiter, decimal)) is not None:
                found[delimiter, decimal] = made
    if not found:
        raise RecordingError(f"{where}: {_why_none(where, lines)}")
    (delimiter, decimal), (score, header) = max(found.items(), key=lambda item: item[1][0])
    other = found.get((delimiter, COMMA if decimal == POINT else POINT))
    if other is not None and other[0] == score:
        _require_one_writing(where, lines, header)
    _require_names_for_all(where, lines, header)
    return header


def _why_none(where: str, lines: Sequence[str]) -> str:
    width = max((len(cells_of(line, ",")) for line in lines[:1]), default=0)
    if width > MOST_COLUMNS:
        return f"its header has {width} columns; keep the few that matter"
    what = "rows of numbers" if any(line.strip() for line in lines[1:]) else "samples"
    return f"has no {what}; expected a header row and one row for each instant"


def _require_one_writing(where: str, lines: Sequence[str], header: Header) -> None:
    """Raise RecordingError where a mark in every number may be the decimal point or the separator of thousands."""
    for line in lines[header.first :]:
        for cell in cells_of(line, header.delimiter):
            for mark in (COMMA, POINT):
                if is_grouped(cell, mark):
                    one, other = cell.replace(mark, "."), cell.replace(mark, "")
                    raise RecordingError(
                        f"{where}: {cell!r} may be {one} or {other}, and no number of the file tells which; write it"
                        " with another number of decimals"
                    )


def _require_names_for_all(where: str, lines: Sequence[str], header: Header) -> None:
    """Raise RecordingError where decimal commas have split each number into two cells."""
    made_up = sum(name.startswith("column ") for name in header.names)
    named = len(header.names) - made_up
    if header.delimiter == "," and named == 0 and header.first > 0:
        above = cells_of(lines[header.first - 1], ",")
        named = len(above) if all(above) and not any(map(is_value_cell, above)) else 0
    row = cells_of(lines[header.first], header.delimiter)
    if (
        2 < named < len(row) - 1 <= 2 * named
        and header.delimiter == ","
        and all(re.fullmatch(r"-?\d+", cell) for cell in row)
    ):
        raise RecordingError(
            f"{where}: has {len(row)} cells in a row under {named} names; its decimal commas divide the cells too:"
            " write it with decimal points, or with ; between the cells"
        )


def is_value_cell(cell: str, decimal: str = POINT) -> bool:
    """Whether a cell has a number or a time."""
    return number_of(cell, decimal, scaled=True) is not None or is_instant(cell)


def _written(lines: Sequence[str], delimiter: str, decimal: str) -> tuple[_Score, Header] | None:
    """How well a delimiter and a decimal point fit the lines, and the header with them; None where they do not fit."""
    rows = {k: cells_of(line, delimiter) for k, line in enumerate(lines) if line.strip() and line[:1] != "#"}
    first = _first_row(rows, decimal)
    if first is None:
        return None
    looked = [row for k, row in rows.items() if k >= first][:_LOOKED_AT]
    width = max(len(row) for row in looked)
    if width < 2:
        return None
    share = sum(values_in(row, decimal)[0] for row in looked) / len(looked)
    names, units = _names(lines, rows, first, width, delimiter)
    if len(names) > MOST_COLUMNS:
        return None
    rate = rate_in(line for line in lines[:first])
    long = long_form_of(names, looked, lambda cell: is_value_cell(cell, decimal))
    # Blanks also separate a date from its clock, so that another delimiter is preferred.
    score = (round(share, 2), delimiter != SPACES, width)
    return score, Header("csv", names, delimiter, decimal, first, units, rate=rate, long=long)


def _first_row(rows: Mapping[int, list[str]], decimal: str) -> int | None:
    """The line at which the numbers begin."""
    order = list(rows)
    full = {k: shares for k, row in rows.items() if (shares := values_in(row, decimal))[1] >= 2}
    starts = [k for k, (share, _) in full.items() if share >= 0.5]
    for k in starts:
        place = order.index(k)
        after = order[place : place + _ALIKE]
        if all(other in full and abs(len(rows[other]) - len(rows[k])) <= 1 for other in after):
            return k
    if starts:
        return starts[0]
    # A table with one number and text in each row, or with mostly empty cells, still has its time.
    return next((k for k, row in rows.items() if len(row) > 1 and values_in(row, decimal)[1]), None)


def values_in(row: Sequence[str], decimal: str) -> tuple[float, int]:
    """The share of a row's filled cells that are numbers or times, and their number."""
    filled = [cell for cell in row if not is_missing(cell)]
    count = sum(is_value_cell(cell, decimal) for cell in filled)
    return (count / len(filled) if filled else 0.0), count


def _names(
    lines: Sequence[str], rows: Mapping[int, list[str]], first: int, width: int, delimiter: str
) -> tuple[list[str], dict[str, str]]:
    """The columns' names and units from the lines above the numbers."""
    above = [rows[k] for k in sorted(rows, reverse=True) if k < first]
    wide = [row for row in above if abs(len(row) - width) <= 1 and any(row)]
    if not wide and first > 0 and lines[first - 1].startswith("#"):
        row = cells_of(lines[first - 1].lstrip("# "), delimiter)
        row = ["#", *row[1:]] if row and not row[0] else row
        wide = [row] if abs(len(row) - width) <= 1 else []
    if not wide:
        return [f"column {k + 1}" for k in range(width)], {}
    names, units = _named(wide), _units_of(wide)
    # A delimiter at the end of each row gives an empty cell, but none in the header.
    names = names[: max(width, len(names) - (not names[-1]))]
    made = [*names, *(f"column {k + 1}" for k in range(len(names), width))]
    stated = {name: unit.strip("[]()<> ") for name, unit in zip(names, units, strict=False) if unit.strip("[]()<>- ")}
    return made, {**{name: found for name in made if (found := unit_in(name))}, **stated}


def _named(wide: Sequence[list[str]]) -> list[str]:
    """The row of names among the rows above the numbers, the nearest first: the labelled or the first suitable one."""
    labelled = next((row for row in wide if row[0].lower() in NAME_LABELS and len(set(row)) > 2), None)
    if labelled is not None and len(wide) > 1:
        return ["time", *labelled[1:]]
    telling = [row for row in wide if not (are_units(row) or _are_types(row) or _is_repeated(row))]
    return (telling or wide)[0]


def _units_of(wide: Sequence[list[str]]) -> list[str]:
    """The row of units among those above the numbers; empty without one in addition to the names."""
    for row in wide if len(wide) > 1 else ():
        if row[0].lower().strip("[]()") in UNIT_LABELS:
            return ["", *row[1:]]
        if are_units(row):
            return row
    return []


def are_units(row: Sequence[str]) -> bool:
    """Whether most filled cells of a row are units."""
    filled = [cell.strip("[]()<> ") for cell in row if cell.strip("[]()<>- ")]
    return bool(filled) and sum(unit_named(cell) is not None for cell in filled) > 0.5 * len(filled)


def _are_types(row: Sequence[str]) -> bool:
    filled = [cell.lower() for cell in row[1:] if cell]
    return bool(filled) and all(cell in _TYPE_NAMES.split() for cell in filled)


def _is_repeated(row: Sequence[str]) -> bool:
    """Whether a row has the same text in most columns, such as their device or raster."""
    filled = [cell for cell in row if cell]
    return len(filled) > 3 and len(set(filled)) <= len(filled) // 2
