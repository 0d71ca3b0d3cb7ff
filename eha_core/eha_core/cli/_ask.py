"""Asks the open questions on a file's channels on a terminal, one by one."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

from eha_core.recording.channel_rules import entry_text
from eha_core.recording.readings import Reading, si_of
from eha_core.recording.suggestions import Question, Suggestions, rule_of
from eha_core.unit_names import UNITS, unit_named

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")


class NoMoreAnswers(Exception):
    """The answers ended before the questions."""


def answered(suggestions: Suggestions) -> Suggestions:
    """The suggestions with the user's answers; questions after the last answer stay open."""
    certain = list(suggestions.certain)
    left: list[Question] = []
    questions = list(suggestions.questions)
    while questions:
        question = questions.pop(0)
        taken = [reading.field for reading in certain if reading.channel != "time"]
        readings = [one for one in question.readings if one is None or one.channel == "time" or one.field not in taken]
        if not any(reading is not None for reading in readings):
            continue
        try:
            chosen = _chosen(question, readings)
            if chosen is not None:
                certain.append(_completed(chosen))
        except NoMoreAnswers:
            left += [question, *questions]
            break
    return Suggestions(tuple(certain), tuple(left))


def _chosen(question: Question, readings: Sequence[Reading | None]) -> Reading | None:
    print(f"\n{question.channel}: {question.text}", file=sys.stderr)
    for k, reading in enumerate(readings):
        print(
            f"  {k + 1}  {entry_text(rule_of(reading)) if reading is not None else 'no such channel'}", file=sys.stderr
        )
    while True:
        line = _answer(f"1 to {len(readings)}, Enter for 1: ")
        if line in ("", *(str(k + 1) for k in range(len(readings)))):
            return readings[int(line or "1") - 1]
        print(f"  {line!r} is not one of them", file=sys.stderr)


def _completed(reading: Reading) -> Reading:
    """A reading with its missing numbers, as the user gives them."""
    if reading.rate is not None and not isfinite(reading.rate):
        return replace(reading, rate=_number("rows in a second", "500 Hz", {"hz": 1.0, "khz": 1e3, "": 1.0}))
    points = []
    stated = UNITS[reading.unit] if reading.unit else None
    factors = {
        name.lower(): unit.scale / stated.scale
        for name, unit in UNITS.items() if stated is not None and unit.si == si_of(reading.channel)
    }  # fmt: skip
    for place, value in reading.points:
        if value is None:
            what = f"{reading.channel} at {place:g} {reading.field.unit}".rstrip()
            value = _number(what, f"250 {reading.unit}", {**factors, "": 1.0})
        points.append((place, value))
    return replace(reading, points=tuple(points))


def _number(what: str, example: str, factors: dict[str, float]) -> float:
    while True:
        line = _answer(f"  {what} [{example}]: ")
        match = _NUMBER.fullmatch(line)
        unit = match[2].strip().lower() if match else ""
        if match is not None and unit not in factors and (known := unit_named(unit)) is not None:
            unit = next((name.lower() for name, one in UNITS.items() if one == known), unit)
        if match is not None and unit in factors:
            return float(match[1]) * factors[unit]
        print(f"  {line!r} is not a number with a unit of it; write for example {example}", file=sys.stderr)


def _answer(prompt: str) -> str:
    print(prompt, end="", file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        print(file=sys.stderr)
        raise NoMoreAnswers
    return line.strip()
