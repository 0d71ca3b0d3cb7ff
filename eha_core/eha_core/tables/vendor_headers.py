"""Headers of measurement systems with their own layout: LabVIEW, ControlDesk, TwinCAT Scope."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import isfinite

from eha_core.errors import RecordingError
from eha_core.tables.number_cells import is_number
from eha_core.tables.stated import unit_in
from eha_core.tables.table import MOST_COLUMNS
from eha_core.tables.text_header import DELIMITERS, UNIT_LABELS, Header, cells_of, plain_header, values_in

_LONGEST_SPACING = 3600.0
"""s; longest sampling period: a header that states more is damaged."""
_LABVIEW_END = "***End_of_Header***"
_TRACE_NAMES = "trace_names"
_FEWEST_PAIRS = 2
_PAIR_LABELS = ("name", "signal", "channel")
"""First cells of a row with alternating labels and names; below each label is a column of times."""


def read_header(where: str, lines: Sequence[str]) -> Header:
    """The header of a table, from its first lines.

    Raises:
        RecordingError: no row of numbers is among them.
    """
    if any(line.startswith(_LABVIEW_END) for line in lines):
        return _labview(where, lines)
    if any(_first_cell(line) == _TRACE_NAMES for line in lines):
        return _traces(where, lines)
    for k, line in enumerate(lines):
        if _first_cell(line) in _PAIR_LABELS and (found := _pairs(where, lines, k)) is not None:
            return found
    return plain_header(where, lines)


def _first_cell(line: str) -> str:
    return re.split(r"[,;\t]", line, maxsplit=1)[0].strip().strip('"').lower()


def _labview(where: str, lines: Sequence[str]) -> Header:
    """The header of a LabVIEW measurement file: tags with values, up to the last end mark of a header."""
    tags: dict[str, str] = {}
    ends = [k for k, line in enumerate(lines) if line.startswith(_LABVIEW_END)][:2]
    # The file states the name of its own separator.
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
    """The header of a ControlDesk recorder's file: rows with labels in the first column, one of them the names.

    Repeated names, such as the blocks' default ones, are replaced by the signals' paths in the model.
    """
    at = next(k for k, line in enumerate(lines) if _first_cell(line) == _TRACE_NAMES)
    delimiter = max(DELIMITERS[:3], key=lines[at].count)
    names = cells_of(lines[at], delimiter)[1:]
    units: list[str] = []
    paths: list[str] = []
    for k in range(at + 1, len(lines)):
        label, *cells = cells_of(lines[k], delimiter) or [""]
        if label.lower() in UNIT_LABELS:
            units = cells
        if label.lower() == "path":
            paths = cells
        if label == "trace_values" or (not label and values_in(cells, ".")[1]):
            decimal = "." if delimiter == "," or values_in(cells, ".") >= values_in(cells, ",") else ","
            names = _told_apart(names, paths)
            # A recorder's first trace without a name is its time, in s.
            if names and not names[0]:
                names[0] = "time [s]"
            stated = {name: unit for name, unit in zip(names, units, strict=False) if unit}
            found = {name: unit for name in names if (unit := unit_in(name))}
            return Header("csv", names, delimiter, decimal, k, {**found, **stated}, skip=1)
    raise RecordingError(f"{where}: has no samples after its header")


def _told_apart(names: list[str], paths: Sequence[str]) -> list[str]:
    """The names, or the unique paths where names repeat."""
    filled = [name for name in names if name]
    if len(set(filled)) == len(filled) or not any(paths):
        return names
    return [path or name for name, path in zip(names, [*paths, *[""] * len(names)], strict=False)]


def _pairs(where: str, lines: Sequence[str], at: int) -> Header | None:
    """The header of a Scope's file in which each signal has a column of its own times, below a column of labels.

    None where the row at `at` does not have alternating labels and names.
    """
    delimiter = max(DELIMITERS[:3], key=lines[at].count)
    row = cells_of(lines[at], delimiter)
    names = row[1::2]
    while names and not names[-1]:
        names.pop()
    labels = row[: 2 * len(names) : 2]
    if len(names) < _FEWEST_PAIRS or len(set(labels)) != 1 or len(set(row[1::2])) < _FEWEST_PAIRS:
        return None
    units, time_unit, first = [""] * len(names), "", None
    for k in range(at + 1, len(lines)):
        cells = cells_of(lines[k], delimiter)
        if values_in(cells, ",")[0] == 1.0 or values_in(cells, ".")[0] == 1.0:
            first = k
            break
        if cells and cells[0].lower() in UNIT_LABELS:
            units = cells[1::2]
        if cells and "time" in cells[0].lower() and unit_in(cells[0]):
            time_unit = unit_in(cells[0])
    if first is None:
        raise RecordingError(f"{where}: has no samples after its header")
    looked = [cells_of(line, delimiter) for line in lines[first : first + 100] if line.strip()]
    shares = {mark: sum(values_in(cells, mark)[0] for cells in looked) for mark in (".", ",")}
    made = [f"{name} time" if of_time else name for name in names for of_time in (True, False)]
    stated = {name: unit for name, unit in zip(names, units, strict=False) if unit}
    found = {name: unit for name in names if (unit := unit_in(name))}
    clocks = {f"{name} time": time_unit for name in names if time_unit}
    decimal = "," if shares[","] > shares["."] and delimiter != "," else "."
    return Header(
        "csv",
        made,
        delimiter,
        decimal,
        first,
        {**found, **stated, **clocks},
        times={name: f"{name} time" for name in names},
    )
