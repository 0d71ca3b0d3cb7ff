"""Reads a CSV file with a header row into one column of numbers for each name."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError

_DELIMITERS = ",;\t"
MOST_COLUMNS = 1000
"""No logger of a rig writes more; a table grows with columns times rows, whatever the file's size."""
LARGEST = 2**30
"""Bytes of a file that is read at once: half a day of ten channels at 500 Hz."""


def read_csv_columns(path: Path) -> tuple[list[str], dict[str, NDArray[np.float64]]]:
    """The header and every column; cells that hold no number are NaN. Raises RecordingError for what is no table."""
    try:
        if path.stat().st_size > LARGEST:
            raise RecordingError(f"{path}: is larger than {LARGEST / 1e9:.1f} GB; cut it, or convert it to MCAP")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError:
        raise RecordingError(f"{path}: not a text file; expected CSV with a header row") from None
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if len(lines) < 2:
        raise RecordingError(f"{path}: has no samples; expected a header row and one row for each instant")
    delimiter = max(_DELIMITERS, key=lines[0].count)
    try:
        header, *rows = ([cell.strip() for cell in row] for row in csv.reader(lines, delimiter=delimiter))
    except csv.Error as error:
        raise RecordingError(f"{path}: not CSV ({error})") from None
    if len(header) > MOST_COLUMNS:
        raise RecordingError(f"{path}: its header has {len(header)} columns; keep the few that matter")
    if len(set(header)) != len(header):
        raise RecordingError(f"{path}: two columns of the header ({', '.join(header)}) share one name; rename one")
    if all(_is_number(cell) for cell in header):
        raise RecordingError(f"{path}: the first row holds numbers; add a header row with the names of the columns")
    table = np.array([[_number(row[i]) if i < len(row) else np.nan for i in range(len(header))] for row in rows])
    return header, {name: table[:, i] for i, name in enumerate(header)}


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def _is_number(cell: str) -> bool:
    return not np.isnan(_number(cell))
