"""Files with columns of numbers, read into one form: text of many writings, MAT, Parquet."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from eha_core.tables.matlab import read_mat_table
from eha_core.tables.parquet import read_parquet_table
from eha_core.tables.table import Column, Table
from eha_core.tables.text_header import unit_in
from eha_core.tables.text_table import read_text_table

__all__ = ["Column", "Table", "is_table", "read_table", "unit_in"]

_READERS: dict[str, Callable[[Path], Table]] = {
    **dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm"), read_text_table),
    ".mat": read_mat_table,
    **dict.fromkeys((".parquet", ".pq"), read_parquet_table),
}


def is_table(path: Path) -> bool:
    """Whether a file is one of columns, judged by its name's ending."""
    return path.suffix.lower() in _READERS


def read_table(path: Path) -> Table:
    """Read a file of columns by the reader of its name's ending; of any other ending as text.

    Raises:
        RecordingError: the file cannot be read as what its ending says, or a library for it is missing.
    """
    return _READERS.get(path.suffix.lower(), read_text_table)(path)
