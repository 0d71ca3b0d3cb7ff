"""Reads the columns of a table, from any kind of file, into samples by channel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.recording.channel_kinds import CHANNEL_KINDS, FloatArray
from eha_core.recording.channel_rules import ChannelRule, quoted
from eha_core.recording.samples import Samples
from eha_core.recording.time_units import TimeUnit, repeats, time_unit, unwrapped, usual_step
from eha_core.recording.topics_file import TopicsFile
from eha_core.tables import Column, Table
from eha_core.unit_names import UNITS

FEWEST = 20
"""Fewest times from which their unit is inferred."""
FINE = 2.0**60
"""ns above which a float resolves no times finer than 0.1 us, so that even steps become uneven."""
FARTHEST = 2**62
"""ns; largest distance of a stamp from 1970: 146 years."""


def channels_of(
    path: Path, table: Table, topics_file: TopicsFile | None
) -> tuple[dict[str, Samples], dict[str, ChannelRule], tuple[str, ...]]:
    """The columns that are channels, and remarks on assumptions and losses.

    Times are in s since any epoch, or as stated by the file or the topics file; dates, and counts that only one epoch
    can have, are recognised.

    Raises:
        RecordingError: no time, a column that the topics file names is not there or has another length, or one loses
            its largest or smallest values.
    """
    given: Mapping[str, ChannelRule | None] = topics_file.channels if topics_file else {}
    clocks = _Clocks(path, table, topics_file.time if topics_file else ChannelRule())
    rules: dict[str, ChannelRule] = {}
    samples: dict[str, Samples] = {}
    remarks = list(table.remarks)
    for name in CHANNEL_KINDS:
        rule = given.get(name, ChannelRule())
        if rule is None:
            continue
        column = rule.column or name
        if column not in table.columns:
            if name in given:
                raise RecordingError(f"{path}: no column {column!r} for channel {name}; there are {_listed(table)}")
            continue
        rules[name] = replace(rule, topic=column, field=None, column=column)
        samples[name] = clocks.samples(name, rules[name])
        remarks += _lost(path, table, name, rules[name])
    if not samples:
        clocks.require_main()
    return samples, rules, (*remarks, *clocks.remarks)


class _Clocks:
    """The stamps of a table's rows: of one time for all columns, or of several."""

    def __init__(self, path: Path, table: Table, rule: ChannelRule) -> None:
        self.remarks: list[str] = []
        self._path, self._table, self._rule = path, table, rule
        self._known: dict[str, tuple[NDArray[np.bool_], NDArray[np.int64]]] = {}

    def samples(self, channel: str, rule: ChannelRule) -> Samples:
        """A channel's numbers at its own times."""
        columns, column = self._table.columns, str(rule.column)
        values = columns[column].astype(np.float64)
        timed, stamps = self._of(self._time_of(column, rule), len(values))
        if len(values) != len(timed):
            time = self._time_of(column, rule)
            raise RecordingError(
                f"{self._path}: {column!r} for channel {channel} has {len(values)} values and the time"
                f" {time!r} has {len(timed)}; name the time that belongs to it"
            )
        if rule.minus is not None:
            if rule.minus not in columns or len(columns[rule.minus]) != len(values):
                raise RecordingError(
                    f"{self._path}: no column {rule.minus!r} as long as {column!r}, for channel {channel}"
                )
            values = values - columns[rule.minus].astype(np.float64)
        # Missing values are counted among the table's losses.
        there = timed & ~np.isnan(values) if column in self._table.losses else timed
        return Samples(stamps[there[timed]], values[there])

    def require_main(self) -> None:
        """Raise RecordingError where a table without channels also has no time, which is then the likely mistake."""
        self._of(self._time_of("", ChannelRule()), None)

    def _time_of(self, column: str, rule: ChannelRule) -> str:
        """The column of a channel's times; empty where its rows are counted instead."""
        if rule.time is not None:
            return rule.time
        if self._rule.column is not None:
            return self._rule.column
        if column in self._table.times:
            return self._table.times[column]
        rate = self._rule.rate or self._table.rate
        return "" if rate is not None and "time" not in self._table.columns else "time"

    def _of(self, time: str, count: int | None) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """Flags of the rows with a time, and these times as stamps."""
        if time in self._known:
            return self._known[time]
        if time == "":
            rate = self._rule.rate or self._table.rate or 1.0
            rows = count if count is not None else max(map(len, self._table.columns.values()))
            remark = f"{self._path}: has no times; its rows were taken as {rate:g} in a second"
            self.remarks += [remark] if remark not in self.remarks else []
            return np.ones(rows, dtype=bool), np.round(np.arange(rows) * (1e9 / rate)).astype(np.int64)
        if time not in self._table.columns:
            raise RecordingError(
                f"{self._path}: no column {time!r} ({_listed(self._table)}); name the times [s] `time` or map them with"
                f" `time: {{column: ...}}` in a topics file, which `eha inspect {self._path} --topics FILE` writes"
            )
        values = self._in_order(time)
        timed = np.isfinite(values.astype(np.float64))
        if not timed.any():
            raise RecordingError(f"{self._path}: column {time!r} holds no numbers; it must be the time in s")
        if not timed.all() and time not in self._table.times.values():
            self.remarks.append(f"{np.count_nonzero(~timed)} rows without a time in {time!r} were left out")
        stated = self._table.units.get(time, "")
        rule = self._rule if time == self._rule.column or self._rule.column is None else ChannelRule()
        stamps, remarks = stamps_of(f"{self._path}: column {time!r}", values[timed], rule, stated, self._table.rate)
        self.remarks += remarks
        self._known[time] = timed, stamps
        return timed, stamps

    def _in_order(self, time: str) -> Column:
        """A column of times. Raises RecordingError where the order of day and month is ambiguous."""
        order = self._table.other_orders.get(time)
        if order is None or self._rule.day_first == order.day_first:
            return self._table.columns[time]
        if self._rule.day_first is None:
            raise RecordingError(
                f"{self._path}: column {time!r}: its dates do not say whether the day or the month stands first; say"
                f" `time: {{column: {quoted(time)}, day_first: true}}`, or false, in a topics file"
            )
        return order.swapped


def _lost(path: Path, table: Table, channel: str, rule: ChannelRule) -> list[str]:
    """The losses of a channel's columns, in words.

    Raises:
        RecordingError: it loses its largest or smallest values.
    """
    said = []
    for column in (str(rule.column), rule.minus):
        loss = table.losses.get(column) if column is not None else None
        if loss is None:
            continue
        if loss.by_value:
            raise RecordingError(
                f"{path}: {column!r} for channel {channel}: {loss}; the rest is not a fair sample: export it anew, or"
                f" leave the channel out with `{channel}: null` in a topics file"
            )
        said.append(f"{channel} ({column}): {loss}")
    return said


def _listed(table: Table) -> str:
    names = list(table.columns)
    return ", ".join(names[:30]) + (f" and {len(names) - 30} more" if len(names) > 30 else "")


def stamps_of(
    where: str, times: Column, rule: ChannelRule, stated: str, rate: float | None = None
) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """The times as stamps [ns], and remarks where their unit was inferred from their size, or a counter wrapped.

    Args:
        where: the begin of messages.
        times: finite times in the order of the file.
        rule: the topics file's rule for them.
        stated: the unit that the file itself states; empty without one.
        rate: rows per second that the file states [Hz]; None without one.

    Raises:
        RecordingError: the unit is not clear, or the times are beyond any calendar.
    """
    times, wrapped = unwrapped(times)
    remarks = (f"{where} {wrapped}",) if wrapped else ()
    scale = rule.scale
    if rule.rate is not None and (usual_step(times) <= 0.0 or repeats(times)):
        # Repeated times are coarser than the samples, which only their number distinguishes.
        return np.round(np.arange(len(times)) * (1e9 / rule.rate)).astype(np.int64), remarks
    if rule.rate is not None:
        scale = 1.0 / (rule.rate * usual_step(times))
    elif (rule.scale, rule.offset, rule.unit) == (1.0, 0.0, None):
        scale, said = _scale(where, times, stated, rate)
        remarks = (*remarks, *said)
    if times.dtype == np.int64 and scale == 1e-9 and rule.offset == 0.0:
        return times, remarks  # exact to the ns, which a float since 1970 is not
    # The first time is subtracted, or an epoch's digits would leave none for the steps.
    first = float(times[0]) * scale + rule.offset
    with np.errstate(over="ignore"):
        since = (times - times[0]).astype(np.float64) * scale * 1e9
    since = _even(since, abs(float(times[0])) * scale * 1e9)
    if abs(first) * 1e9 > FARTHEST and scale in (UNITS["day"].scale, UNITS["100ns"].scale):
        first = 0.0  # since the year 0, 1 or 1601; only differences matter
    if not (abs(first) * 1e9 <= FARTHEST and float(np.max(np.abs(since))) <= FARTHEST):
        raise RecordingError(f"{where} is beyond any calendar; it must be in s, or say its `unit` in a topics file")
    return round(first * 1e9) + np.round(since).astype(np.int64), remarks


def _even(since: FloatArray, size: float) -> FloatArray:
    """Times [ns] since the first, at even steps where they differ from these by no more than a float's resolution: that
    of a day number is 10 us."""
    if len(since) < FEWEST or size < FINE:
        return since
    count = np.arange(len(since), dtype=np.float64)
    slope, start = np.polyfit(count, since, 1)
    even = start + slope * count
    return even - start if float(np.max(np.abs(since - even))) <= 2.0 * float(np.spacing(size)) else since


def _scale(where: str, times: Column, stated: str, rate: float | None) -> tuple[float, tuple[str, ...]]:
    """The factor from times to seconds without a topics file's rule, and a remark where it is not certain."""
    with np.errstate(over="ignore"):
        steps = np.abs(np.diff(times).astype(np.float64))
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    found = time_unit(float(times[0]), step, stated, rate)
    if not stated and (step == 0.0 or len(times) < FEWEST):
        return 1.0, ()
    if not found.is_certain:
        if rate is not None and step > 0.0:
            return 1.0 / (rate * step), (f"{where} counts samples of the stated rate of {rate:g} Hz",)
        raise RecordingError(
            f"{where} goes by steps of {step:.4g}, which are not seconds; say its unit in a topics file,"
            " for example `channels: {time: {scale: 1.0e-3}}` for ms, or its rate with `channels: {time: {rate: 500}}`"
        )
    return UNITS[found.units[0]].scale, (_said(where, step, stated, found),) if found.why else ()


def _said(where: str, step: float, stated: str, found: TimeUnit) -> str:
    how = "" if stated else f"goes by steps of {step:.4g} and "
    return f"{where} {how}was taken as {found.why}"
