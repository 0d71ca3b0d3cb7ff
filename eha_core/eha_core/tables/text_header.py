"""Says how a text table is written: what comes before the numbers, and what divides and points them."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite

from eha_core.errors import RecordingError
from eha_core.tables.table import MOST_COLUMNS
from eha_core.tables.text_cells import is_date, is_number

SPACES = " "
"""Stands for any number of blanks between cells."""
_DELIMITERS = ("\t", ";", ",", SPACES)
_LOOKED_AT = 40
"""Rows that decide how a table is written."""
_LONGEST_SPACING = 3600.0
"""s between samples; what states more has a damaged header."""
_LABVIEW_END = "***End_of_Header***"
_TRACE_NAMES, _TRACE_UNITS = "trace_names", ("unit", "units", "trace_units")
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]$")
_UNIT = re.compile(r"[\[(<]?[-%°µμA-Za-z/^0-9.*²³·]{1,10}[\])>]?")


@dataclass(frozen=True)
class Header:
    """How a text table is written.

    Attributes:
        kind: "csv" or "lvm".
        names: the columns' names; made up where the file has none.
        units: units by name, where the file states them.
        delimiter: what divides the cells; SPACES for any blanks.
        decimal: the decimal point, "." or ",".
        first: line of the file at which the numbers begin, from 0.
        skip: cells at the beginning of each row that belong to no column.
        step: first value and spacing of the first column, where its cells are empty.
        named: whether the names are the file's own.
    """

    kind: str
    names: list[str]
    delimiter: str
    decimal: str
    first: int
    units: dict[str, str] = field(default_factory=dict)
    skip: int = 0
    step: tuple[float, float] | None = None
    named: bool = True


def read_header(where: str, lines: Sequence[str]) -> Header:
    """The header of a table, from its first lines.

    Raises:
        RecordingError: no row of numbers is among them.
    """
    if any(line.startswith(_LABVIEW_END) for line in lines):
        return _labview(where, lines)
    if any(_first_cell(line) == _TRACE_NAMES for line in lines):
        return _traces(where, lines)
    return _plain(where, lines)


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without blanks around them."""
    if delimiter == SPACES:
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]
    except csv.Error:
        return []


def _plain(where: str, lines: Sequence[str]) -> Header:
    best: tuple[tuple[float, int], Header] | None = None
    for delimiter in _DELIMITERS:
        for decimal in (".", ",") if delimiter != "," else (".",):
            found = _written(lines, delimiter, decimal)
            if found is not None and (best is None or found[0] > best[0]):
                best = found
    if best is None:
        if not any(line.strip() for line in lines[1:]):
            raise RecordingError(f"{where}: has no samples; expected a header row and one row for each instant")
        width = max(len(cells_of(line, ",")) for line in lines[:1])
        if width > MOST_COLUMNS:
            raise RecordingError(f"{where}: its header has {width} columns; keep the few that matter")
        raise RecordingError(f"{where}: has no rows of numbers; expected a header row and one row for each instant")
    return best[1]


def _written(lines: Sequence[str], delimiter: str, decimal: str) -> tuple[tuple[float, int], Header] | None:
    """How well the lines read as a table that is written so, and its header; None where they do not."""
    rows = {k: cells_of(line, delimiter) for k, line in enumerate(lines) if line.strip() and line[:1] != "#"}
    full = {k: shares for k, row in rows.items() if (shares := _numeric(row, decimal))[1] >= 2}
    starts = [k for k, (share, _) in full.items() if share >= 0.5]
    if not starts:
        # A table of one number a row beside text, or of cells that are mostly empty, still has its time.
        starts = [k for k, row in rows.items() if len(row) > 1 and _numeric(row, decimal)[1]]
    if not starts:
        return None
    first = starts[0]
    looked = [row for k, row in rows.items() if k >= first][:_LOOKED_AT]
    width = max(len(row) for row in looked)
    if width < 2:
        return None
    share = sum(_numeric(row, decimal)[0] for row in looked) / len(looked)
    names, units, named = _names(lines, rows, first, width, delimiter)
    if len(names) > MOST_COLUMNS:
        return None
    return (round(share, 2), width), Header("csv", names, delimiter, decimal, first, units, named=named)


def _numeric(row: Sequence[str], decimal: str) -> tuple[float, int]:
    """Which share of a row's filled cells are numbers or dates, and how many."""
    filled = [cell for cell in row if cell]
    count = sum(_is_value(cell, decimal) for cell in filled)
    return (count / len(filled) if filled else 0.0), count


def _is_value(cell: str, decimal: str) -> bool:
    return is_date(cell) or is_number(cell.replace(",", ".") if decimal == "," else cell)


def _names(
    lines: Sequence[str], rows: dict[int, list[str]], first: int, width: int, delimiter: str
) -> tuple[list[str], dict[str, str], bool]:
    """The columns' names and units from the lines above the numbers, and whether the file has names."""
    above = [rows[k] for k in sorted(rows, reverse=True) if k < first]
    wide = [row for row in above if abs(len(row) - width) <= 1 and any(row)]
    if not wide and first > 0 and lines[first - 1].startswith("#"):
        row = cells_of(lines[first - 1].lstrip("# "), delimiter)
        wide = [row] if abs(len(row) - width) <= 1 else []
    if not wide:
        return [f"column {k + 1}" for k in range(width)], {}, False
    names, units = wide[0], [""] * len(wide[0])
    if len(wide) > 1 and _are_units(wide[0]):
        units, names = wide[0], wide[1]
    # A delimiter at the end of each row makes an empty cell, and none in the header.
    names = names[: max(width, len(names) - (not names[-1]))]
    made = [*names, *(f"column {k + 1}" for k in range(len(names), width))]
    stated = {name: unit.strip("[]()<> ") for name, unit in zip(names, units, strict=False) if unit.strip("[]()<>- ")}
    return made, {**{name: found for name in made if (found := unit_in(name))}, **stated}, True


def _are_units(row: Sequence[str]) -> bool:
    """Whether a row under the names holds their units: short, and bracketed or of few letters."""
    filled = [cell for cell in row if cell]
    return bool(filled) and all(_UNIT.fullmatch(cell) for cell in filled)


def unit_in(name: str) -> str:
    """The unit that a name states in brackets at its end, as in `p_A [bar]`; empty where it states none."""
    match = _BRACKETS.search(name.strip())
    return match[1].strip() if match else ""


def _labview(where: str, lines: Sequence[str]) -> Header:
    """The header of a LabVIEW measurement file: tags with values, up to the last mark of a header's end."""
    tags: dict[str, str] = {}
    ends = [k for k, line in enumerate(lines) if line.startswith(_LABVIEW_END)][:2]
    # The separator is stated by name in the file that it separates.
    delimiter = "," if any(line.lower().startswith("separator,") for line in lines[: ends[0]]) else "\t"
    for line in lines[: ends[-1]]:
        tag, *values = cells_of(line, delimiter)[:MOST_COLUMNS] or [""]
        tags[tag.lower()] = delimiter.join(values)
    named = next((k for k in range(ends[-1] + 1, len(lines)) if lines[k].strip()), None)
    if named is None or named + 1 >= len(lines):
        raise RecordingError(f"{where}: has no samples after its header")
    names = cells_of(lines[named], delimiter)
    decimal = "," if tags.get("decimal_separator", ".").strip() == "," else "."
    first_of = {tag: tags.get(tag, "").split(delimiter)[0].replace(",", ".") for tag in ("x0", "delta_x")}
    step = None
    if tags.get("x_columns", "").lower() == "no" and all(map(is_number, first_of.values())):
        start, spacing = float(first_of["x0"]), float(first_of["delta_x"])
        step = (start, spacing) if isfinite(start) and 0.0 < spacing < _LONGEST_SPACING else None
    units = dict(zip(names[1:], tags.get("y_unit_label", "").split(delimiter), strict=False))
    stated = {name: unit.strip() for name, unit in units.items() if unit.strip()}
    if tags.get("x_dimension", "").startswith("Time"):
        stated[names[0]] = "s"
    found = {name: unit for name in names if (unit := unit_in(name))}
    return Header("lvm", names, delimiter, decimal, named + 1, {**found, **stated}, step=step)


def _traces(where: str, lines: Sequence[str]) -> Header:
    """The header of a ControlDesk recorder's file: labelled rows, the names among them, in a first column of labels."""
    at = next(k for k, line in enumerate(lines) if _first_cell(line) == _TRACE_NAMES)
    delimiter = max(_DELIMITERS[:3], key=lines[at].count)
    names = cells_of(lines[at], delimiter)[1:]
    units: dict[str, str] = {}
    for k in range(at + 1, len(lines)):
        label, *cells = cells_of(lines[k], delimiter) or [""]
        if label.lower() in _TRACE_UNITS:
            units = {name: unit for name, unit in zip(names, cells, strict=False) if unit}
        if label == "trace_values" or (not label and _numeric(cells, ".")[1]):
            decimal = "." if delimiter == "," or _numeric(cells, ".") >= _numeric(cells, ",") else ","
            return Header("csv", names, delimiter, decimal, k, units, skip=1)
    raise RecordingError(f"{where}: has no samples after its header")


def _first_cell(line: str) -> str:
    return re.split(r"[,;\t]", line, maxsplit=1)[0].strip().strip('"').lower()
