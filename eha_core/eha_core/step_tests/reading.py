"""Reads the command and the motion of a step test from any table, or from a recording of messages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from eha_core.chosen_columns import stated_units
from eha_core.errors import EhaError, RecordingError
from eha_core.recording import CHANNEL_KINDS, ChannelRule, read_recording
from eha_core.recording.stated_units import unit_of_name
from eha_core.recording.table_file import stamps_of
from eha_core.step_tests.columns import (
    COMMAND_UNITS,
    POSITION_UNITS,
    VELOCITY_UNITS,
    Columns,
    Selection,
    command_column,
    motion_column,
    time_column,
)
from eha_core.step_tests.result import Array, Record
from eha_core.tables import Table, is_table, read_table
from eha_core.unit_names import Unit, name_of, unit_named

FEWEST = 20
"""Fewest samples of a record: ten before and ten after a change show no more than whether something moved (assumed)."""

_NANOSECOND = 1e-9

File = str | Path | Mapping[str, ArrayLike]


def records_of(files: Sequence[File], selection: Selection) -> list[Record]:
    """The records of files, or of columns by name, all in the units of the first.

    Raises:
        RecordingError: a file cannot be read.
        EhaError: a column, its unit or the time is missing, several may be meant, or files have different quantities.
    """
    units = stated_units(selection.units, "deg")
    given = [_columns(file, selection, units) for file in files]
    for name in units:
        if not any(name in columns.units for columns in given):
            given[0].require(name, "--unit")
    records = [_record(columns, selection) for columns in given]
    return [_in_units_of(records[0], record) for record in records]


def _record(columns: Columns, selection: Selection) -> Record:
    command, motion = command_column(columns, selection), motion_column(columns, selection)
    if command == motion:
        raise EhaError(f"{columns.source}: {command!r} cannot be command and motion; choose two columns")
    of_command = columns.unit(command, COMMAND_UNITS)
    of_motion = columns.unit(motion, (*POSITION_UNITS, *VELOCITY_UNITS))
    command_time, commands = columns.series(command)
    time, values = columns.series(motion)
    if time.size < FEWEST or commands.size == 0:
        raise EhaError(
            f"{columns.source}: {motion!r} has {time.size} samples and {command!r} {commands.size}; record {FEWEST} at"
            " least, from rest before the step on"
        )
    first = float(time[0])
    own = not np.array_equal(time, command_time)
    return Record(
        columns.source, time - first, values, name_of(of_motion), of_motion.si in VELOCITY_UNITS,
        command_time - first, commands, name_of(of_command), own, columns.remarks,
    )  # fmt: skip


def _in_units_of(first: Record, record: Record) -> Record:
    """A record in the units of the first. Raises EhaError where it has other quantities."""
    factors = []
    for mine, wanted, what in (
        (record.motion_unit, first.motion_unit, "motion"), (record.command_unit, first.command_unit, "command"),
    ):  # fmt: skip
        one, other = unit_named(mine), unit_named(wanted)
        if one is None or other is None or one.si != other.si:
            raise EhaError(
                f"{record.source}: its {what} is in {mine}, that of {first.source} in {wanted}; give files with the"
                f" same quantity, or choose the column with --{what}"
            )
        factors.append(one.scale / other.scale)
    return replace(record, motion=record.motion * factors[0], motion_unit=first.motion_unit,
                   command=record.command * factors[1], command_unit=first.command_unit)  # fmt: skip


def _columns(file: File, selection: Selection, units: Mapping[str, Unit]) -> Columns:
    if isinstance(file, Mapping):
        table = Table("columns", {name: np.asarray(values, float) for name, values in file.items()})
        return _of_table("columns", table, selection, units)
    path = Path(file)
    if not path.exists():
        raise RecordingError(f"{path}: there is no such file or folder")
    if selection.topics is None and is_table(path):
        return _of_table(path.name, read_table(path), selection, units)
    return _of_recording(path, selection, units)


def _of_recording(path: Path, selection: Selection, units: Mapping[str, Unit]) -> Columns:
    """The channels of a recording, in SI units; --unit relabels one, as position=rad of a joint."""
    recording = read_recording(path, selection.topics)
    known: dict[str, Unit | None] = {name: unit_named(CHANNEL_KINDS[name].unit) for name in recording.channels}
    known |= {name: unit for name, unit in units.items() if name in known}

    def series(name: str) -> tuple[Array, Array]:
        channel = recording.channels[name]
        return _whole(path.name, name, channel.time, channel.values)

    return Columns(path.name, known, series)


def _of_table(source: str, table: Table, selection: Selection, units: Mapping[str, Unit]) -> Columns:
    names = tuple(table.columns)
    known = {name: unit_named(table.units.get(name) or unit_of_name(name, names)) for name in names}
    known |= {name: unit for name, unit in units.items() if name in known}

    def series(name: str) -> tuple[Array, Array]:
        if (loss := table.losses.get(name)) is not None and loss.by_value:
            raise EhaError(f"{source}: {name!r}: {loss}; the rest is not a fair sample: export it anew")
        values = np.asarray(table.columns[name], dtype=np.float64)
        return _whole(source, name, _times(source, table, name, selection), values)

    return Columns(source, known, series, table.remarks)


def _times(source: str, table: Table, name: str, selection: Selection) -> Array:
    """The instants of a column [s], NaN where a row has none."""
    time = selection.time or table.times.get(name) or time_column(tuple(table.columns))
    if time is None and table.rate is not None:
        return np.arange(len(table.columns[name])) / table.rate
    if time is None or time not in table.columns:
        have = ", ".join(table.columns)
        what = "no column is a time" if time is None else f"has no column {time!r} for --time"
        raise EhaError(f"{source}: {what}; choose one with --time COLUMN; it has {have}")
    times = table.columns[time]
    there = np.isfinite(times.astype(np.float64))
    if not there.any():
        raise EhaError(f"{source}: column {time!r} holds no numbers; choose another with --time COLUMN")
    stated = selection.units.get(time) or table.units.get(time) or unit_of_name(time, tuple(table.columns))
    stamps, _ = stamps_of(f"{source}: column {time!r}", times[there], ChannelRule(), stated, table.rate)
    found = np.full(len(times), np.nan)
    found[there] = stamps * _NANOSECOND
    return found


def _whole(source: str, name: str, time: Array, values: Array) -> tuple[Array, Array]:
    """The rows with both numbers. Raises EhaError where lengths differ or the time goes back."""
    if time.shape != values.shape:
        raise EhaError(f"{source}: {name!r} has {values.size} values and its time {time.size}; name its time, --time")
    there = np.isfinite(time) & np.isfinite(values)
    time, values = time[there], values[there]
    if np.any(np.diff(time) < 0.0):
        raise EhaError(f"{source}: the time goes back after {float(time[np.argmin(np.diff(time))]):.4g} s; give one"
                       " record in a file")  # fmt: skip
    kept = np.append(True, np.diff(time) > 0.0)[: time.size]
    return time[kept], values[kept]
