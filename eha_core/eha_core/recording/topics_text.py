"""Writes a topics file: channels that are certain as entries, questions as comments to choose from."""

from __future__ import annotations

from pathlib import Path

import yaml

from eha_core.errors import RecordingError
from eha_core.recording.inspection import Inspection
from eha_core.recording.suggestions import Question, Reading, Suggestions, used


def topics_text(inspection: Inspection, suggestions: Suggestions) -> str:
    """The text of a topics file that `eha diagnose --topics` takes once its questions are answered."""
    lines = [f"# Channels of {_quoted(inspection.path.name)}, as `eha inspect` found them."]
    if suggestions.questions:
        lines.append("# Lines with a ? are questions: take the # away from the one answer that is right.")
    lines.append("channels:")
    lines += [f"  {_entry(reading)}" for reading in suggestions.certain]
    for question in suggestions.questions:
        lines += _asked(question)
    found = used(suggestions)
    unused = [field for field in inspection.fields if (field.topic, field.path) not in found]
    if unused:
        lines.append(
            "# not taken for a channel: " + ", ".join(_quoted(_name(field.topic, field.path)) for field in unused)
        )
    return "\n".join(lines) + "\n"


def write_topics(path: Path, text: str) -> None:
    """Write a topics file. Raises RecordingError where there is a file already, or it cannot be written."""
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise RecordingError(f"{path}: exists already; choose another name") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written ({error.strerror})") from error


def _asked(question: Question) -> list[str]:
    fields = dict.fromkeys(_name(reading.field.topic, reading.field.path) for reading in question.readings)
    lines = [f"  # ? {', '.join(map(_quoted, fields))}: {question.text}"]
    if not question.is_open:
        return [*lines, *(f"  # {_entry(reading)}" for reading in question.readings)]
    for channel in dict.fromkeys(reading.channel for reading in question.readings):
        ways = [reading for reading in question.readings if reading.channel == channel]
        units = list(dict.fromkeys(reading.unit for reading in ways))
        references = list(dict.fromkeys(reading.reference for reading in ways))
        choices = [f"or {' or '.join(map(str, rest))}" for rest in (units[1:], references[1:]) if rest]
        lines.append(f"  # {_entry(ways[0])}" + (f"  # {', '.join(choices)}" if choices else ""))
    return lines


def _name(topic: str, path: str) -> str:
    return f"{topic} {path}" if topic else path


def _entry(reading: Reading) -> str:
    field = reading.field
    where = {"topic": field.topic, "field": field.path} if field.topic else {"column": field.path}
    parts = [f"{key}: {_quoted(value)}" for key, value in where.items()]
    parts += [f"{key}: {value}" for key, value in (("unit", reading.unit), ("reference", reading.reference)) if value]
    return f"{reading.channel}: {{{', '.join(parts)}}}"


def _quoted(text: str) -> str:
    """A text in YAML's quotes on one line, whatever a file calls its columns."""
    return str(yaml.safe_dump(text, default_style='"', allow_unicode=True, width=2**20)).strip()
