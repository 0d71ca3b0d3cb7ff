"""What the page shows of a file: its columns with their outlines, what each may be, and what is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

from eha_core.errors import printable
from eha_core.page.rows import ROWS_OF_FILE, Row, row_of
from eha_core.plant import composition_of
from eha_core.plant.parts import parts
from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.inspection import KINDS, Field, Inspection
from eha_core.recording.readings import Reading, si_of
from eha_core.recording.suggestions import Question, Suggestions, rate_of, rule_of
from eha_core.rig import DATA, asked_of
from eha_core.unit_names import UNITS


def choices() -> dict[str, Any]:
    """What there is to choose from whatever the file: channels with their units, and the lines of a data sheet."""
    channels = [
        {"name": name, "meaning": kind.meaning, "si": kind.unit, "is_pressure": kind.is_pressure,
         "units": [unit for unit, row in UNITS.items() if row.si == kind.unit and row.reference is None]}
        for name, kind in CHANNEL_KINDS.items()
    ]  # fmt: skip
    time = {
        "name": "time", "meaning": "time of each row", "si": "s", "is_pressure": False,
        "units": [unit for unit, row in UNITS.items() if row.si == "s"],
    }  # fmt: skip
    sources = [
        {"name": name, "summary": source.summary,
         "data": [datum.name for datum in asked_of(composition_of({"source": name}))]}
        for name, source in sorted(parts("source").items())
    ]  # fmt: skip
    data = {datum.name: {"meaning": datum.meaning, "example": datum.example} for datum in DATA}
    return {"channels": [time, *channels], "sources": sources, "data": data}


def description(inspection: Inspection, suggestions: Suggestions, rows: Sequence[Row]) -> dict[str, Any]:
    """A file as the page takes it, with `rows` as what is known of it."""
    notes = [*inspection.remarks]
    notes += [f"not usable: {field.path!r}: {field.problem}" for field in inspection.fields if field.problem]
    notes += [f"damaged: {inspection.damaged}"] if inspection.damaged else []
    rate = rate_of(inspection, suggestions)
    return {
        "name": printable(inspection.path.name), "kind": KINDS[inspection.kind],
        "columns": [_column(field, rate) for field in inspection.fields],
        "rows": [row.as_json() for row in rows],
        "questions": [_question(question, inspection) for question in suggestions.questions],
        "notes": notes,
    }  # fmt: skip


def certain_rows(inspection: Inspection, suggestions: Suggestions) -> list[Row]:
    """The channels that are certain."""
    found = [row_of(reading.channel, rule_of(reading), inspection) for reading in suggestions.certain]
    return [row for row in found if row is not None]


def _column(field: Field, rate: float) -> dict[str, Any]:
    return {
        "name": printable(f"{field.topic} {field.path}".strip()), "count": field.count, "unit": printable(field.unit),
        "low": _number(field.low), "high": _number(field.high), "rate": _number(field.rate if field.topic else rate),
        "usable": bool(field.count) and not field.problem,
        "outline": [[_number(low), _number(high)] for low, high in field.outline],
    }  # fmt: skip


def _number(value: float) -> float | None:
    """A number as JSON has it, to the digits that a plot shows."""
    return float(f"{value:.7g}") if isfinite(value) else None


def _question(question: Question, inspection: Inspection) -> dict[str, Any]:
    answers: list[Mapping[str, Any] | None] = []
    for reading in question.readings:
        if reading is None:
            answers.append(None)
            continue
        row = row_of(reading.channel, rule_of(reading), inspection)
        row = row or Row(ROWS_OF_FILE, reading.channel, rate=reading.rate)
        answers.append({"text": _answer(reading), "row": row.as_json()})
    return {"channel": question.channel, "text": printable(question.text), "answers": answers}


def _answer(reading: Reading) -> str:
    """A possible answer in words."""
    name = printable(f"{reading.field.topic} {reading.field.path}".strip())
    said = [f'"{name}"' if name else "the rows of the file"]
    said += [f'less "{printable(reading.minus.path)}"'] if reading.minus is not None else []
    if reading.rate is not None:
        said.append("counts rows" + (f", {reading.rate:g} in a second" if isfinite(reading.rate) else ""))
    elif reading.points:
        places = " and ".join(f"{raw:g}" for raw, _ in reading.points)
        said.append(f"by what {places} {reading.field.unit} mean".replace("  ", " "))
    else:
        said.append(f"in {reading.unit or reading.field.unit or si_of(reading.channel)}")
    said += [] if reading.day_first is None else ["day first" if reading.day_first else "month first"]
    said += [reading.reference] if reading.reference else []
    return " ".join(said)
