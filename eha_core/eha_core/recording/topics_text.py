"""Writes a topics file: certain channels as entries, questions with their possible answers as data."""

from __future__ import annotations

from pathlib import Path

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import entry_text, quoted
from eha_core.recording.inspection import Inspection
from eha_core.recording.readings import Reading
from eha_core.recording.suggestions import Question, Suggestions, rule_of, used


def topics_text(inspection: Inspection, suggestions: Suggestions) -> str:
    """The text of a topics file for `eha diagnose --topics`, once its questions are answered."""
    lines = [f"# Channels of {quoted(inspection.path.name)}, as `eha inspect` found them."]
    if suggestions.questions:
        lines.append("# Where it says `ask`, put the right one of the answers in place of `{question: ..., ask: ...}`;")
        lines.append(
            "# a null inside an answer is a number to fill in, an answer `null` means that there is no such channel."
        )
    lines.append("channels:")
    for reading in suggestions.certain:
        lines.append(f"  {reading.channel}: {entry_text(rule_of(reading))}")
    for question in suggestions.questions:
        lines += [f"  {question.channel}:", f"    question: {quoted(question.text)}", "    ask:"]
        lines += [f"      - {_candidate(reading, question)}" for reading in question.readings]
    if len(lines) > 1 and lines[-1] == "channels:":
        lines[-1] = "channels: {}"
    found = used(suggestions)
    times = {field.time for field in inspection.fields if (field.topic, field.path) in found and field.time}
    unused = [
        field for field in inspection.fields if (field.topic, field.path) not in found and field.path not in times
    ]
    if unused:
        names = ", ".join(quoted(f"{field.topic} {field.path}" if field.topic else field.path) for field in unused)
        lines.append(f"# not taken for a channel: {names}")
    return "\n".join(lines) + "\n"


def _candidate(reading: Reading | None, question: Question) -> str:
    """A possible answer; where several columns are in question, with the range of its own."""
    if reading is None:
        return entry_text(None)
    field = reading.field
    span = f"  # it goes from {field.low:.4g} to {field.high:.4g}" if question.is_open else ""
    return f"{entry_text(rule_of(reading))}{span}"


def write_topics(path: Path, text: str) -> None:
    """Write a topics file. Raises RecordingError where there is a file already, or it cannot be written."""
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise RecordingError(f"{path}: exists already; choose another name") from None
    except OSError as error:
        raise RecordingError(f"{path}: cannot be written ({error.strerror})") from error
