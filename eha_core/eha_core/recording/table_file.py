"""Reads the columns of a table, whatever file they are in, into samples by channel."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ChannelRule, TopicsFile
from eha_core.recording.recording import CHANNEL_KINDS
from eha_core.recording.samples import Samples
from eha_core.tables import Column, Table
from eha_core.unit_names import unit_named

LONGEST_STEP = 1.0
"""s between samples from which on a time is no second's count: so slow a recording shows no actuator's dynamics."""
FEWEST = 20
"""Times below which nothing is said of their unit."""
SHORTEST_STEP_NS = 2e4
"""ns between samples down to which a time may count them: 50 kHz."""
FARTHEST = 2**62
"""ns from 1970 that a stamp may lie: 146 years."""
EPOCHS = {"ms": (1e12, 4e12), "us": (1e15, 4e15), "ns": (1e18, 4e18)}
"""Counts since 1970 that lie between 2001 and 2096, by unit; those in s need no word."""


def channels_of(
    path: Path, table: Table, topics_file: TopicsFile | None
) -> tuple[dict[str, Samples], dict[str, ChannelRule], tuple[str, ...]]:
    """The columns that are channels, and remarks on what was assumed.

    Times are s, since any epoch, or what the file or the topics file says; dates, and counts of ms, us or ns since
    1970, are recognised.

    Raises:
        RecordingError: no time column, or a column that the topics file names is not there or has another length.
    """
    columns, listed = table.columns, _listed(table)
    time_rule = topics_file.time if topics_file else ChannelRule()
    time_column = time_rule.column or "time"
    if time_column not in columns:
        raise RecordingError(
            f"{path}: no column {time_column!r} ({listed}); name the times [s] `time` or map them with"
            f" `time: {{column: ...}}` in a topics file, which `eha inspect {path} --topics FILE` writes"
        )
    timed = np.isfinite(columns[time_column])
    if not timed.any():
        raise RecordingError(f"{path}: column {time_column!r} holds no numbers; it must be the time in s")
    where = f"{path}: column {time_column!r}"
    stated = table.units.get(time_column, "")
    stamps, remarks = stamps_of(where, columns[time_column][timed], time_rule, stated)
    given: Mapping[str, ChannelRule | None] = topics_file.channels if topics_file else {}
    rules: dict[str, ChannelRule] = {}
    for name in CHANNEL_KINDS:
        rule = given.get(name, ChannelRule())
        if rule is None:
            continue
        column = rule.column or name
        if column in columns:
            if len(columns[column]) != len(timed):
                raise RecordingError(
                    f"{path}: {column!r} for channel {name} has {len(columns[column])} values and the time"
                    f" {time_column!r} has {len(timed)}; name the time that belongs to it"
                )
            rules[name] = ChannelRule(column, None, column, rule.scale, rule.offset, rule.reference, rule.unit)
        elif name in given:
            raise RecordingError(f"{path}: no column {column!r} for channel {name}; there are {listed}")
    samples = {
        name: Samples(stamps, columns[str(rule.column)][timed].astype(np.float64)) for name, rule in rules.items()
    }
    return samples, rules, (*table.remarks, *remarks)


def _listed(table: Table) -> str:
    names = list(table.columns)
    return ", ".join(names[:30]) + (f" and {len(names) - 30} more" if len(names) > 30 else "")


def stamps_of(where: str, times: Column, rule: ChannelRule, stated: str) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """The times as stamps [ns], and a remark where their unit was taken from their size.

    Args:
        where: how messages begin.
        times: finite times in the order of the file.
        rule: what a topics file says of them.
        stated: the unit that the file itself states; empty where it states none.

    Raises:
        RecordingError: the unit is open, or the times are beyond any calendar.
    """
    scale = rule.scale
    remarks: tuple[str, ...] = ()
    if (rule.scale, rule.offset, rule.unit) == (1.0, 0.0, None):
        scale, remarks = _scale(where, times, stated)
    if times.dtype == np.int64 and scale == 1e-9 and rule.offset == 0.0:
        return times, remarks  # to the last ns, which a float cannot tell since 1970
    # The first time is set apart, or an epoch's digits would leave none for the steps.
    first = float(times[0]) * scale + rule.offset
    with np.errstate(over="ignore"):
        since = (times - times[0]).astype(np.float64) * scale * 1e9
    if not (abs(first) * 1e9 <= FARTHEST and float(np.max(np.abs(since))) <= FARTHEST):
        raise RecordingError(f"{where} is beyond any calendar; it must be in s, or say its `unit` in a topics file")
    return round(first * 1e9) + np.round(since).astype(np.int64), remarks


def _scale(where: str, times: Column, stated: str) -> tuple[float, tuple[str, ...]]:
    """What makes seconds of times of which no topics file says anything, and a remark where it is no certain thing."""
    if (unit := unit_named(stated)) and unit.si == "s":
        return unit.scale, () if unit.scale in (1.0, 1e-9) else (f"{where} was taken as {stated}, as the file says",)
    first = abs(float(times[0]))
    with np.errstate(over="ignore"):
        steps = np.abs(np.diff(times.astype(np.float64)))
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if step < LONGEST_STEP or len(times) < FEWEST:
        return 1.0, ()
    epoch = next((name for name, (low, high) in EPOCHS.items() if low <= first < high), None)
    if epoch is None and step < SHORTEST_STEP_NS:
        raise RecordingError(
            f"{where} goes by steps of {step:.4g}, which are no seconds; say its unit in a topics file,"
            " for example `channels: {time: {scale: 1.0e-3}}` for ms"
        )
    epoch = epoch or "ns"
    found = unit_named(epoch)
    assert found is not None
    since = " since 1970" if first >= EPOCHS[epoch][0] else ""
    return found.scale, (f"{where} goes by steps of {step:.4g} and was taken as {epoch}{since}",)
