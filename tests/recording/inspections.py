"""Fields of a table or a bag as inspection finds them, and what is suggested of them."""

from __future__ import annotations

from math import nan
from pathlib import Path

from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.suggestions import Question, Suggestions, suggest


def a_field(path: str, largest: float, topic: str = "") -> Field:
    return Field(topic, path, 100, -largest, largest, 500.0, "", 0.0, 2e-3 if path == "time" else 0.0)


def a_time(unit: str = "s", first: float = 0.0, step: float = 2e-3) -> Field:
    return Field("", "time", 100, first, first + 99 * step, nan, unit, first, step)


def a_column(name: str, low: float, high: float, unit: str = "") -> Field:
    return Field("", name, 100, low, high, nan, unit, low, 0.0)


def of_table(*fields: Field) -> Suggestions:
    return suggest(Inspection(Path("run.csv"), "csv", (a_time(), *fields), {}, ()))


def certain_of(found: Suggestions) -> dict[str, tuple[str, str | None, str | None]]:
    return {one.channel: (one.field.path, one.unit, one.reference) for one in found.certain if one.channel != "time"}


def ways(question: Question) -> list[tuple[str, str | None, str | None]]:
    return [(one.channel, one.unit, one.reference) for one in question.readings if one is not None]
