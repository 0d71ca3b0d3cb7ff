"""Reads JSON: one record per line, a list of records, or lists of numbers by name."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eha_core.errors import RecordingError
from eha_core.tables.assembled import assembled
from eha_core.tables.gathered_columns import GatheredColumn
from eha_core.tables.long_form import long_form_of
from eha_core.tables.stated import unit_in
from eha_core.tables.table import LARGEST, MOST_CELLS, MOST_COLUMNS, Table
from eha_core.tables.text_header import is_value_cell
from eha_core.tables.text_table import encoding_of

DEEPEST = 4
"""Most levels of nested objects; a historian's record has two."""
_DECIDING = 200


def read_json_table(path: Path) -> Table:
    """Read JSON lines, or a JSON document of records or of lists; objects in objects are columns such as `a.b`.

    Raises:
        RecordingError: the file is not JSON, or has no records of numbers.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        encoding = encoding_of(path)
        with path.open(encoding=encoding) as file:
            records, unread = _records(path, file.read())
    except (OSError, UnicodeError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from error
    names = list(dict.fromkeys(name for record in records for name in record))
    if not names:
        raise RecordingError(f"{path}: holds no records of numbers")
    if len(names) > MOST_COLUMNS or len(names) * len(records) > MOST_CELLS:
        raise RecordingError(f"{path}: has more than {MOST_CELLS} numbers or {MOST_COLUMNS} columns; keep fewer")
    columns = {name: np.array([record.get(name) for record in records], dtype=object) for name in names}
    rows = [[_text(record.get(name)) for name in names] for record in records[:_DECIDING]]
    long = long_form_of(names, rows, is_value_cell)
    texts = {*long.names, long.unit} if long else set()
    gathered = []
    for k, (name, cells) in enumerate(columns.items()):
        column = GatheredColumn(name, unit=unit_in(name), is_text=k in texts)
        values, unreadable, other = column.read(_numbers(cells))
        column.add(cells, values, unreadable, other)
        gathered.append(column)
    remarks = (f"{unread} lines that are not records were left out",) if unread else ()
    return assembled(str(path), "json", gathered, long=long, remarks=remarks)


def _text(value: Any) -> str:
    return "" if value is None else str(value)


def _numbers(cells: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Cells as an array of numbers, if all are numbers."""
    if all(isinstance(cell, int) and abs(cell) < 2**63 for cell in cells):
        return cells.astype(np.int64)
    if all(cell is None or isinstance(cell, (int, float)) for cell in cells):
        return np.array([np.nan if cell is None else float(cell) for cell in cells])
    return np.array([cell if cell is None else str(cell) for cell in cells], dtype=object)


def _records(path: Path, text: str) -> tuple[list[dict[str, Any]], int]:
    """The records of a file, flat, and the number of lines that are not records."""
    lines = [line for line in text.splitlines() if line.strip()]
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):
        document = None
    if isinstance(document, list):
        return [dict(_flat("", one, DEEPEST)) for one in document if isinstance(one, dict)], 0
    if isinstance(document, dict) and (found := _by_name(document)):
        return found, 0
    found, unread = [], 0
    for line in lines:
        try:
            record = json.loads(line)
        except (ValueError, RecursionError):
            record = None
        if isinstance(record, dict):
            found.append(dict(_flat("", record, DEEPEST)))
        else:
            unread += 1
    if not found or unread > len(found):
        raise RecordingError(f"{path}: holds no JSON records, one a line, nor a list of them")
    return found, unread


def _by_name(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The rows of lists by name, at the top level or one below; empty without any."""
    lists = {name: value for name, value in document.items() if isinstance(value, list) and len(value) > 1}
    if not lists:
        inner = [value for value in document.values() if isinstance(value, dict)]
        return next((rows for one in inner if (rows := _by_name(one))), [])
    if len(lists) == 1 and all(isinstance(one, dict) for one in next(iter(lists.values()))):
        return [dict(_flat("", one, DEEPEST)) for one in next(iter(lists.values()))]
    count = max(map(len, lists.values()))
    return [{name: values[k] for name, values in lists.items() if k < len(values)} for k in range(count)]


def _flat(start: str, value: Any, levels: int) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict) and levels:
        for name, inner in value.items():
            yield from _flat(f"{start}.{name}" if start else str(name), inner, levels - 1)
    elif isinstance(value, list) and levels and len(value) <= 16:
        for k, inner in enumerate(value):
            yield from _flat(f"{start}[{k}]", inner, levels - 1)
    elif not isinstance(value, (dict, list)):
        yield start, value
