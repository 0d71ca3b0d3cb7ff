"""Files with columns of numbers, read into one form: text in many formats, and the files of measurement systems."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from eha_core.errors import RecordingError
from eha_core.tables.json_table import read_json_table
from eha_core.tables.matlab import read_mat_table
from eha_core.tables.measurement_files import read_mdf, read_tdms
from eha_core.tables.other_kinds import READABLE, refuse_other_kinds, refuse_unknown
from eha_core.tables.parquet import read_parquet_table
from eha_core.tables.spreadsheet import read_spreadsheet
from eha_core.tables.stated import unit_in
from eha_core.tables.table import Column, Loss, Table
from eha_core.tables.text_table import read_text_table

__all__ = ["READABLE", "Column", "Loss", "Table", "is_table", "read_table", "unit_in"]

_READERS: dict[str, Callable[[Path], Table]] = {
    **dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm", ".prn", ".log"), read_text_table),
    **dict.fromkeys((".mat", ".h5", ".hdf5"), read_mat_table),
    **dict.fromkeys((".parquet", ".pq"), read_parquet_table),
    **dict.fromkeys((".jsonl", ".ndjson", ".json"), read_json_table),
    **dict.fromkeys((".xlsx", ".xlsm"), read_spreadsheet),
    ".tdms": read_tdms,
    **dict.fromkeys((".mf4", ".mdf"), read_mdf),
}
_OF_MESSAGES = (".mcap", ".db3", ".zstd")
"""Endings of files of messages."""
_MCAP, _SQLITE = b"\x89MCAP", b"SQLite format 3"


def is_table(path: Path) -> bool:
    """Whether a file has columns: by its ending, or for an unknown ending because it has no messages."""
    ending = path.suffix.lower()
    if ending in _READERS or not path.is_file():
        return ending in _READERS
    if ending in _OF_MESSAGES:
        return False
    try:
        with path.open("rb") as file:
            return not file.read(16).startswith((_MCAP, _SQLITE))
    except OSError:
        return False


def read_table(path: Path) -> Table:
    """Read a file of columns with the reader for its ending; with an unknown ending as text.

    Raises:
        RecordingError: the file's kind has no columns, the file does not have the format of its ending, or a library
            for it is missing.
    """
    ending = path.suffix.lower()
    try:
        refuse_other_kinds(path)
        if ending not in _READERS:
            refuse_unknown(path)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from error
    return _READERS.get(ending, read_text_table)(path)
