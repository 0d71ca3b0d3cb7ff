"""The table that every kind of file with columns is read into."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError

Column = NDArray[Any]
"""One-dimensional, of float64; or of int64 where every value is an integer that float64 may not represent."""

MOST_COLUMNS = 1000
"""Most columns: no logger of a rig writes more, and a table's size is columns times rows, whatever the file's."""
MOST_CELLS = 2**27
"""Most numbers of a table, which take 1 GB: three hours of ten channels at 1 kHz."""
MOST_MEMORY = 3 * 2**29
"""Most bytes for reading a table and listing its contents: half of a small laptop's free memory (assumed). The longest
table that fits is still one of three hours of ten channels at 1 kHz."""
COPIES = 5
"""Copies of one column that are in memory at once while it is converted and outlined."""
LONGEST_QUOTE = 40
"""Most characters of a cell that are quoted."""
LARGEST = 2**30
"""Most bytes of a file; a larger one has to be converted to MCAP or cut."""


@dataclass(frozen=True)
class Loss:
    """The losses of a column.

    Attributes:
        empty: number of empty cells.
        unreadable: number of cells with something else than the column's content.
        first: the first of those, as in the file.
        row: its row, counted from 1 among the rows of values.
        by_value: whether cells are lost where the column is at its largest or smallest, so that the rest is not
            a fair sample of the measurement.
    """

    empty: int = 0
    unreadable: int = 0
    first: str = ""
    row: int = 0
    by_value: bool = False

    def __str__(self) -> str:
        said = [f"{self.empty} cells are empty"] if self.empty else []
        if self.unreadable:
            quoted = self.first if len(self.first) <= LONGEST_QUOTE else f"{self.first[:LONGEST_QUOTE]}..."
            said.append(f"{self.unreadable} cells could not be read, the first {quoted!r} in row {self.row}")
        return " and ".join(said) + (", all where it is largest or smallest" if self.by_value else "")


@dataclass(frozen=True)
class OtherOrder:
    """Dates whose order of day and month is ambiguous.

    Attributes:
        day_first: the order in which they were read, the one that makes the shorter record.
        swapped: the column in the other order.
    """

    day_first: bool
    swapped: Column


@dataclass(frozen=True)
class Table:
    """Columns by name.

    Attributes:
        kind: the kind of file, such as "csv", "lvm", "mat" or "parquet".
        columns: the columns in the order of the file; of one length, except in files of variables.
        units: units that the file itself states, by column; "ns" for dates and times of day.
        remarks: what was excluded or renamed.
        times: the column of a column's own times, by column; the others share the table's time.
        rate: rows per second that the file states [Hz]; None where it states none.
        losses: the losses by column; columns without loss are not in it.
        other_orders: by column, its dates in the other order of day and month, where both fit and samples move.
    """

    kind: str
    columns: Mapping[str, Column]
    units: Mapping[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    times: Mapping[str, str] = field(default_factory=dict)
    rate: float | None = None
    losses: Mapping[str, Loss] = field(default_factory=dict)
    other_orders: Mapping[str, OtherOrder] = field(default_factory=dict)


def refuse_large(where: object, cells: int, columns: int, longest: int) -> None:
    """Raise RecordingError for a table that takes too much memory, before it is read.

    Args:
        where: the file.
        cells: number of all columns' cells.
        columns: number of columns.
        longest: length of the longest column.
    """
    needed = 8 * (cells + COPIES * longest)
    if cells > MOST_CELLS or columns > MOST_COLUMNS:
        raise RecordingError(f"{where}: has more than {MOST_CELLS} numbers or {MOST_COLUMNS} columns; keep fewer")
    if needed > MOST_MEMORY:
        raise RecordingError(
            f"{where}: takes {needed / 1e9:.1f} GB to read, more than {MOST_MEMORY / 1e9:.1f} GB; keep fewer numbers, "
            "or convert it to MCAP"
        )


def as_column(values: Any) -> Column | None:
    """Values as a column: int64 for integers, else float64; None if they are not numbers."""
    array = np.asarray(values)
    if array.dtype.kind in "mM":
        return array.astype("datetime64[ns]" if array.dtype.kind == "M" else "timedelta64[ns]").astype(np.int64)
    if array.dtype.kind in "iu" and array.dtype.itemsize == 8:
        return array.astype(np.int64)
    return array.astype(np.float64) if array.dtype.kind in "biuf" else None


def distinct(names: list[str]) -> tuple[list[str], tuple[str, ...]]:
    """The names, repeated ones numbered so that each is unique, and a remark on these."""
    doubled = sorted({name for name in names if names.count(name) > 1}) if len(set(names)) < len(names) else []
    counts: dict[str, int] = {}
    made = []
    for position, name in enumerate(names):
        name = name or f"column {position + 1}"
        counts[name] = counts.get(name, 0) + 1
        made.append(f"{name} ({counts[name]})" if name in doubled else name)
    remarks = tuple(
        f"{counts[name]} columns are called {name}; they are {name} (1) and so on" for name in doubled if name
    )
    return made, remarks
