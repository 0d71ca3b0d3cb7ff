"""Reads a CSV file with a header row into samples by channel."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from eha_core.csv_table import read_csv_columns
from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ChannelRule, TopicsFile
from eha_core.recording.recording import CHANNEL_KINDS
from eha_core.recording.samples import Samples


def read_csv(path: Path, topics_file: TopicsFile | None) -> tuple[dict[str, Samples], dict[str, ChannelRule]]:
    """Read the columns that are channels; cells that hold no number become NaN, a short last row likewise.

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
    seconds = columns[time_column] * time_rule.scale + time_rule.offset
    if not np.isfinite(seconds).any():
        raise RecordingError(f"{path}: column {time_column!r} holds no numbers; it must be the time in s")
    timed = np.isfinite(seconds)
    stamps = np.round(seconds[timed] * 1e9).astype(np.int64)
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
    return {name: Samples(stamps, columns[str(rule.column)][timed]) for name, rule in rules.items()}, rules
