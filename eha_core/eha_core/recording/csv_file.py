"""Reads a CSV file with a header row into samples by channel."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eha_core.csv_table import read_csv_columns
from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ChannelRule, TopicsFile
from eha_core.recording.recording import CHANNEL_KINDS, FloatArray
from eha_core.recording.samples import Samples

LONGEST_STEP = 1.0
"""s between samples from which on a time is no second's count: so slow a recording shows no actuator's dynamics."""
FEWEST = 20
"""Times below which nothing is said of their unit."""
SHORTEST_STEP_NS = 2e4
"""ns between samples down to which a time may count them: 50 kHz."""
FARTHEST = 2**62
"""ns from 1970 that a stamp may lie: 146 years."""


def read_csv(
    path: Path, topics_file: TopicsFile | None
) -> tuple[dict[str, Samples], dict[str, ChannelRule], tuple[str, ...]]:
    """Read the columns that are channels, and remark on what was assumed.

    Cells that hold no number become NaN, a short last row likewise. Times are s, since any epoch, or ns.

    Raises:
        RecordingError: no header, no time column, or a column that the topics file names is not there.
    """
    header, columns = read_csv_columns(path)
    time_rule = topics_file.time if topics_file else ChannelRule()
    time_column = time_rule.column or "time"
    if time_column not in columns:
        raise RecordingError(
            f"{path}: no column {time_column!r} in the header ({', '.join(header)});"
            " name the times [s] `time` or map them with `time: {column: ...}` in a topics file"
        )
    timed = np.isfinite(columns[time_column])
    if not timed.any():
        raise RecordingError(f"{path}: column {time_column!r} holds no numbers; it must be the time in s")
    where = f"{path}: column {time_column!r}"
    stamps, remarks = _stamps(where, columns[time_column][timed], time_rule)
    given: Mapping[str, ChannelRule | None] = topics_file.channels if topics_file else {}
    rules: dict[str, ChannelRule] = {}
    for name in CHANNEL_KINDS:
        rule = given.get(name, ChannelRule())
        if rule is None:
            continue
        column = rule.column or name
        if column in columns:
            rules[name] = ChannelRule(column, None, column, rule.scale, rule.offset, rule.reference)
        elif name in given:
            raise RecordingError(f"{path}: no column {column!r} for channel {name}; the header has {', '.join(header)}")
    return {name: Samples(stamps, columns[str(rule.column)][timed]) for name, rule in rules.items()}, rules, remarks


def _stamps(where: str, times: FloatArray, rule: ChannelRule) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """The times as stamps [ns], and a remark where their unit was taken from their size.

    Raises:
        RecordingError: the unit is open, or the times are beyond any calendar.
    """
    scale = rule.scale
    remarks: tuple[str, ...] = ()
    steps = np.abs(np.diff(times))
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    if rule == ChannelRule(column=rule.column) and step >= LONGEST_STEP and len(times) >= FEWEST:
        if step < SHORTEST_STEP_NS:
            raise RecordingError(
                f"{where} goes by steps of {step:.4g}, which are no seconds; say its unit in a topics file,"
                " for example `channels: {time: {scale: 1.0e-3}}` for ms"
            )
        scale = 1e-9
        remarks = (f"{where} goes by steps of {step:.4g} and was taken as ns",)
    # The first time is set apart, or an epoch's digits would leave none for the steps.
    start = round((float(times[0]) * scale + rule.offset) * 1e9)
    since = (times - times[0]) * scale * 1e9
    if abs(start) > FARTHEST or float(np.max(np.abs(since))) > FARTHEST:
        raise RecordingError(f"{where} is beyond any calendar; it must be in s, or say its `scale` in a topics file")
    return start + np.round(since).astype(np.int64), remarks
