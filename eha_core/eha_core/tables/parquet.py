"""Reads Parquet files with pyarrow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from eha_core.errors import RecordingError
from eha_core.tables.optional import required
from eha_core.tables.table import Column, Table, as_column, refuse_large


def read_parquet_table(path: Path) -> Table:
    """Read the columns of numbers or times of a Parquet file; a missing value is NaN.

    Raises:
        RecordingError: the file is damaged, of another kind, or too large.
    """
    parquet = required("pyarrow.parquet", path, "Parquet files")
    arrow = required("pyarrow", path, "Parquet files")
    try:
        with parquet.ParquetFile(path) as file:
            schema = file.schema_arrow
            wanted = [k for k, field in enumerate(schema) if _is_numeric(arrow, field.type)]
            rows, groups = file.metadata.num_rows, file.metadata.num_row_groups
            if groups > rows:
                raise RecordingError(f"{path}: has more groups of rows than rows; write it anew")
            refuse_large(path, rows * len(wanted), len(wanted), rows)
            names = [schema.names[k] for k in wanted]
            # One column after the other: all in Arrow's form would be a second table in memory.
            columns = {
                name: _column(arrow, file.read(columns=[name], use_threads=False).column(name)) for name in names
            }
            units = {name: unit for name in names if (unit := _unit(arrow, schema.field(name)))}
    except (arrow.ArrowException, OSError, ValueError, KeyError, TypeError, OverflowError, MemoryError) as error:
        raise RecordingError(f"{path}: cannot be read as a Parquet file ({error})") from error
    if not columns or not rows:
        raise RecordingError(f"{path}: holds no column of numbers")
    return Table("parquet", columns, units)


def _is_numeric(arrow: Any, kind: Any) -> bool:
    types = arrow.types
    tests = (types.is_integer, types.is_floating, types.is_boolean, types.is_timestamp, types.is_duration)
    return any(test(kind) for test in tests)


def _column(arrow: Any, values: Any) -> Column:
    if arrow.types.is_timestamp(values.type) or arrow.types.is_duration(values.type):
        kind = arrow.timestamp("ns") if arrow.types.is_timestamp(values.type) else arrow.duration("ns")
        values = values.cast(kind).cast(arrow.int64())
    if values.null_count or arrow.types.is_boolean(values.type) or arrow.types.is_floating(values.type):
        values = values.cast(arrow.float64(), safe=False)
    column = as_column(values.to_numpy())
    return column if column is not None else np.full(len(values), np.nan)


def _unit(arrow: Any, field: Any) -> str:
    """The unit of a column: ns for times, else `unit` or `units` of its metadata."""
    if arrow.types.is_timestamp(field.type) or arrow.types.is_duration(field.type):
        return "ns"
    stated = field.metadata or {}
    return str((stated.get(b"unit") or stated.get(b"units") or b"").decode(errors="replace"))
