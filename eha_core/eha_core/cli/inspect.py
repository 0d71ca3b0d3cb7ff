"""`eha inspect`: list the contents of a log file, and write a topics file that maps them to channels."""

from __future__ import annotations

import argparse
import sys
from math import isnan
from pathlib import Path

from eha_core.cli._ask import answered
from eha_core.errors import EhaError, printable
from eha_core.recording.inspection import KINDS, Field, Inspection, inspect_file
from eha_core.recording.suggestions import Suggestions, rate_of, suggest, used
from eha_core.recording.topics_file import assumptions
from eha_core.recording.topics_text import topics_text, write_topics
from eha_core.tables import READABLE

UNUSABLE = 2
"""Exit status where nothing in the file can be a channel."""
DAMAGED = 3
"""Exit status where the file was damaged and the list rests on the part that could be read."""
WIDEST = 60
"""Characters of a name in the list; the topics file has it in full."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb."""
    parser = subparsers.add_parser(
        "inspect",
        help="list the contents of a log file and write a topics file for it",
        description=__doc__,
        epilog="A channel is certain if only one column or topic has its name and the unit is stated; everything else"
        " is a question. On a terminal the questions are asked one by one; otherwise they are in the topics file, with"
        " their possible answers.",
    )
    add = parser.add_argument
    add("file", type=Path, metavar="FILE", help=READABLE)
    add("--topics", type=Path, metavar="FILE", help="write a topics file there, for `eha diagnose --topics`; where"
        " questions are asked, by default FILE.topics.yaml in this folder")  # fmt: skip
    add("--ask", action="store_true", help="ask the questions, also if the answers come from a pipe")


def run(arguments: argparse.Namespace) -> int:
    """Run the verb."""
    if arguments.topics is not None and arguments.topics.exists():
        raise EhaError(f"{arguments.topics}: exists already; choose another name")
    inspection = inspect_file(arguments.file)
    suggestions = suggest(inspection)
    print("\n".join(_listing(inspection, suggestions)))
    found = {reading.channel for reading in suggestions.certain} | {asked.channel for asked in suggestions.questions}
    if not found - {"time"}:
        print(f"eha inspect: {arguments.file}: holds nothing that can be a channel; {_WANTED}", file=sys.stderr)
        return UNUSABLE
    topics = arguments.topics
    if suggestions.questions and (arguments.ask or (sys.stdin.isatty() and sys.stdout.isatty())):
        topics = topics or Path(f"{arguments.file.name}.topics.yaml")
        if topics.exists():
            raise EhaError(f"{topics}: exists already; choose another name with --topics")
        suggestions = answered(suggestions)
    if topics is not None:
        write_topics(topics, topics_text(inspection, suggestions))
        print(f"\n{topics}: {_counted(suggestions)}")
        is_open = " once they are answered" if suggestions.questions else ""
        print(f"Go on{is_open} with: eha diagnose {arguments.file} --topics {topics}")
    else:
        print(f"\n{_counted(suggestions)}; --topics FILE writes them down")
    return DAMAGED if inspection.damaged else 0


_WANTED = "needed are a valve's command, a position, pressures or a force, each over time"


def _counted(suggestions: Suggestions) -> str:
    certain = sum(reading.channel != "time" for reading in suggestions.certain)
    asked = len(suggestions.questions)
    return f"{certain} channel{'' if certain == 1 else 's'} certain, {asked} question{'' if asked == 1 else 's'}"


def _listing(inspection: Inspection, suggestions: Suggestions) -> list[str]:
    rate = rate_of(inspection, suggestions)
    rows: list[tuple[str, ...]] = [("name", "values", "rate [Hz]", "lowest", "highest", "unit", "channel")]
    channels = used(suggestions)
    unknown = {
        (reading.field.topic, reading.field.path)
        for asked in suggestions.questions
        if asked.is_open
        for reading in asked.readings
        if reading is not None
    }
    sure = {(reading.field.topic, reading.field.path) for reading in suggestions.certain}
    for field in inspection.fields:
        place = (field.topic, field.path)
        likely = " or ".join(channels.get(place, ["-"])) if place not in unknown else ""
        rows.append(_row(field, rate, likely if place in sure or place not in channels else f"{likely}?"))
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    right = (False, True, True, True, True, False, False)
    lines = [f"{printable(str(inspection.path))}: {KINDS[inspection.kind]}"]
    for row in rows:
        cells = [
            cell.rjust(width) if to_right else cell.ljust(width)
            for cell, width, to_right in zip(row, widths, right, strict=True)
        ]
        lines.append("  ".join(cells).rstrip())
    lines += [f"note: {remark}" for remark in inspection.remarks]
    lines += [f"note: not usable: {field.path!r}: {field.problem}" for field in inspection.fields if field.problem]
    lines += [f"question: {question.channel}: {printable(question.text)}" for question in suggestions.questions]
    lines += assumptions({reading.channel: reading.assumed for reading in suggestions.certain})
    return lines + ([f"damaged: {inspection.damaged}"] if inspection.damaged else [])


def _row(field: Field, rate: float, channel: str) -> tuple[str, ...]:
    name = printable(f"{field.topic} {field.path}".strip())
    name = name if len(name) <= WIDEST else f"...{name[3 - WIDEST :]}"
    shown = field.rate if field.topic else rate
    numbers = ["-" if isnan(value) else f"{value:.5g}" for value in (shown, field.low, field.high)]
    return (name, str(field.count), *numbers, printable(field.unit) or "-", channel)
