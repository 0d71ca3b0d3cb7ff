"""What a person says of a file's columns on the page, as a topics file, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from math import isfinite, nan
from typing import Any

from eha_core.errors import RecordingError
from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.channel_rules import ChannelRule, Points, entry_text, quoted
from eha_core.recording.inspection import Field, Inspection

ROWS_OF_FILE = -1
"""Stands for no column: the time is then the number of rows."""
TURNED: Points = ((0.0, 0.0), (1.0, -1.0))
"""A column whose sign is the other one."""


@dataclass(frozen=True)
class Row:
    """One column that is a channel.

    Attributes:
        column: its place among the inspection's fields, or ROWS_OF_FILE.
        channel: which channel it is, or "time".
        unit: in which unit; empty where it is SI or stated by its message.
        reference: "absolute" or "gauge", of a pressure; else empty.
        turned: whether its sign is the other one.
        points: pairs of what was recorded and what it means in `unit`; a value that is still to be said is None.
        minus: the column that is taken from it; None where none is.
        rate: rows in a second, of a time that counts them; NaN where that is still to be said, None for other times.
        day_first: of a time, whether the day stands before the month in its dates; None where nothing hangs on it.
        assumed: what was taken without a question; empty where nothing was, or a person said otherwise.
    """

    column: int
    channel: str
    unit: str = ""
    reference: str = ""
    turned: bool = False
    points: Points = ()
    minus: int | None = None
    rate: float | None = None
    day_first: bool | None = None
    assumed: str = ""

    def as_json(self) -> dict[str, Any]:
        """The row as the page takes it; numbers that are still to be said are null."""
        open_rate = self.rate is not None and not isfinite(self.rate)
        return {**asdict(self), "rate": None if open_rate else self.rate, "counts": self.rate is not None}


def row_of_json(given: Any) -> Row:
    """A row as the page sends it. Raises RecordingError for one that the page does not send."""
    try:
        counts = bool(given.get("counts"))
        points = tuple((float(raw), None if value is None else float(value)) for raw, value in given["points"])
        rate = (nan if given.get("rate") is None else float(given["rate"])) if counts else None
        minus = given.get("minus")
        return Row(
            int(given["column"]), str(given["channel"]), str(given.get("unit") or ""),
            str(given.get("reference") or ""), bool(given.get("turned")), points,
            None if minus is None else int(minus), rate,
            None if given.get("day_first") is None else bool(given["day_first"]), str(given.get("assumed") or ""),
        )  # fmt: skip
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RecordingError("a row of the page says nothing of a column; load the page again") from error


def row_of(channel: str, rule: ChannelRule, inspection: Inspection) -> Row | None:
    """A rule of a topics file as a row; None where the file has no such column."""
    places = {(field.topic, field.path): k for k, field in enumerate(inspection.fields)}
    topic, path = (rule.topic, rule.field) if rule.topic is not None else ("", rule.column or channel)
    column = places.get((topic, path or ""))
    if column is None and channel == "time" and rule.column is None and rule.rate is not None:
        column = ROWS_OF_FILE
    if column is None:
        return None
    turned = rule.points == TURNED
    points = () if turned else rule.points
    if not points and rule.unit is None and (rule.scale, rule.offset) != (1.0, 0.0):
        points = ((0.0, rule.offset), (1.0, rule.offset + rule.scale))
    minus = places.get(("", rule.minus)) if rule.minus is not None else None
    return Row(
        column,
        channel,
        rule.unit or "",
        rule.reference or "",
        turned,
        points,
        minus,
        rule.rate,
        rule.day_first,
        rule.assumed,
    )


def rule_of_row(row: Row, fields: Sequence[Field]) -> ChannelRule:
    """A row as a rule. Raises RecordingError for a column that the file does not have, or numbers that are missing."""
    kind = CHANNEL_KINDS.get(row.channel)
    if kind is None and row.channel != "time":
        raise RecordingError(f"{row.channel!r} is no channel; choose {', '.join(CHANNEL_KINDS)}")
    if not ROWS_OF_FILE <= row.column < len(fields) or not (row.minus is None or 0 <= row.minus < len(fields)):
        raise RecordingError(f"{row.channel}: the file has no such column; load the page again")
    if row.rate is not None and not (isfinite(row.rate) and row.rate > 0.0):
        raise RecordingError("time: say how many rows there are in a second")
    points = _complete(row)
    if row.turned:
        points = tuple((raw, -value) for raw, value in points if value is not None) if points else TURNED
    field = fields[row.column] if row.column != ROWS_OF_FILE else None
    minus = fields[row.minus].path if row.minus is not None else None
    reference = row.reference or None if kind is not None and kind.is_pressure else None
    if field is None:
        return ChannelRule(rate=row.rate)
    rule = ChannelRule(
        points=points, unit=row.unit or None, reference=reference, minus=minus, rate=row.rate,
        day_first=row.day_first, assumed=row.assumed,
    )  # fmt: skip
    if field.topic:
        return replace(rule, topic=field.topic, field=field.path)
    return replace(rule, column=field.path, time=field.time or None if row.channel != "time" else None)


def _complete(row: Row) -> Points:
    for raw, value in row.points:
        if value is None or not (isfinite(value) and isfinite(raw)):
            unit = row.unit or (CHANNEL_KINDS[row.channel].unit if row.channel in CHANNEL_KINDS else "s")
            raise RecordingError(f"{row.channel}: say what {raw:g} as recorded means in {unit}")
    return row.points


def topics_text_of(rows: Sequence[Row], without: Sequence[str], inspection: Inspection) -> str:
    """The topics file of what was said.

    Args:
        rows: the columns that are channels.
        without: channels that the file does not hold.
        inspection: what the file holds.

    Raises:
        RecordingError: a channel is said of two columns, none is said, or a row is not complete.
    """
    rules: dict[str, ChannelRule | None] = {}
    for row in rows:
        if row.channel in rules:
            raise RecordingError(f"{row.channel}: two columns are said to be it; choose one")
        rules[row.channel] = rule_of_row(row, inspection.fields)
    if not set(rules) - {"time"}:
        raise RecordingError("no column is said to be a channel; say what at least one column is")
    rules |= dict.fromkeys((channel for channel in without if channel in CHANNEL_KINDS and channel not in rules), None)
    lines = [f"# Channels of {quoted(inspection.path.name)}, as said on the page of `eha open`.", "channels:"]
    return "\n".join([*lines, *(f"  {name}: {entry_text(rule)}" for name, rule in rules.items())]) + "\n"


def refuse_open(rows: Sequence[Row], without: Sequence[str], asked: Mapping[str, str]) -> None:
    """Raise RecordingError for the first question that is still open."""
    answered = {row.channel for row in rows} | set(without)
    for channel, text in asked.items():
        if channel not in answered:
            raise RecordingError(f"still open: {channel}: {text}")
