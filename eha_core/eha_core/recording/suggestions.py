"""Suggests which channel each number of a file may be, by its name, unit and range: certain, or as a question."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan

from eha_core.errors import RecordingError
from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.column_names import common_words
from eha_core.recording.discovery import find_rules
from eha_core.recording.field_meanings import MeantField, is_doubled, meant
from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.readings import BELOW_ZERO, Reading, is_usual, readings_of, si_of
from eha_core.recording.time_suggestions import suggest_time
from eha_core.unit_names import unit_named

_CHANNELS = (
    "voltage_command", "current", "spool", "flow_a", "flow_b", "pressure_a", "pressure_b", "pump_speed",
    "supply_pressure", "position", "velocity", "force",
)  # fmt: skip
_USUAL_CHANNELS = ("voltage_command", "position", "pressure_a", "pressure_b")
"""The channels that are asked for among columns without a meaningful name, where no other column is one."""
_IN_PLACE = "is this to be the force of the oil on the piston, in place of both pressures?"
MOST_UNNAMED = 12
"""Most fields without a meaningful name that are offered."""
_ONE_SIDED = 1e-3
"""Share of its largest value by which a one-sided command may be below zero."""


@dataclass(frozen=True)
class Question:
    """A question about a channel that only the user can answer, and the possible answers, the likely one first.

    None among them means no such channel. `is_open` marks a question about fields with neither a meaningful name nor a
    unit.
    """

    channel: str
    text: str
    readings: tuple[Reading | None, ...]
    is_open: bool = False


@dataclass(frozen=True)
class Suggestions:
    """The channels of a file: certain ones, and questions about others; for a table, `time` is among them."""

    certain: tuple[Reading, ...]
    questions: tuple[Question, ...]


def suggest(inspection: Inspection) -> Suggestions:
    """Which channels a file's numbers may be.

    A channel is certain if only one field has its name and the unit is known from the file, the name or the message's
    type; everything else is a question.
    """
    certain: list[Reading] = []
    questions: list[Question] = []
    usable = [field for field in inspection.fields if field.count and not field.problem]
    if not inspection.topics:
        for one in suggest_time(inspection, usable):
            if isinstance(one, Reading):
                certain.append(one)
            else:
                questions.append(Question("time", one.text, one.readings))
    times = {reading.field for reading in certain} | {
        reading.field for question in questions for reading in question.readings if reading is not None
    }
    known = _by_contract(inspection)
    taken = [*(reading.field for reading in known.values()), *times]
    common = common_words([field.path for field in usable if not field.topic])
    fields = [
        meant(field, common) for field in usable
        if field not in taken and not is_doubled(field, inspection) and (field.low != 0.0 or field.high != 0.0)
    ]  # fmt: skip
    claims = _claims(fields)
    both = all(name in known or claims[name] for name in ("pressure_a", "pressure_b"))
    for channel in _CHANNELS:
        if channel in known:
            certain.append(known[channel])
        elif claims[channel] and not (channel == "force" and both and (known or _are_torques(claims[channel]))):
            found = _of_channel(channel, claims, both)
            certain += [found] if isinstance(found, Reading) else []
            questions += [found] if isinstance(found, Question) else []
    if not (inspection.topics and known):
        questions += _open_questions(fields, certain, questions)
    return Suggestions(tuple(certain), tuple(questions))


def _are_torques(fields: Sequence[MeantField]) -> bool:
    """Whether fields give a force only by a lever, so that no question is needed where both pressures are known."""
    return all((unit := unit_named(one.field.unit)) is not None and unit.si == "N m" for one in fields)


def _by_contract(inspection: Inspection) -> dict[str, Reading]:
    """The channels that are read without a topics file."""
    if not inspection.topics:
        named = {field.path: field for field in inspection.fields if field.count and not field.problem}
        exact = {name: named[name] for name in CHANNEL_KINDS if name in named and named[name].unit in ("", si_of(name))}
        sound = {
            name: one for name, one in exact.items() if not CHANNEL_KINDS[name].is_pressure or one.low > BELOW_ZERO
        }
        return {name: Reading(name, field) for name, field in sound.items() if is_usual(name, field)}
    try:
        rules, _ = find_rules(str(inspection.path), inspection.topics.keys(), None)
    except RecordingError:
        return {}
    found = {}
    for name, rule in rules.items():
        of_topic = [field for field in inspection.fields if field.topic == rule.topic and field.count]
        start = str(rule.field).partition("[")[0]
        fitting = [field for field in of_topic if field.path == rule.field]
        fitting = fitting or [field for field in of_topic if field.path.partition("[")[0] == start]
        if len(fitting) == 1:
            found[name] = Reading(name, fitting[0], None, rule.reference)
    return found


def _claims(fields: Sequence[MeantField]) -> dict[str, list[MeantField]]:
    """The fields that may be each channel: those named so, or else those in its unit without a meaningful name."""
    claims: dict[str, list[MeantField]] = {}
    for channel in _CHANNELS:
        called = [one for one in fields if channel in one.meaning.channels]
        single = [one for one in called if one.meaning.channels == {channel}]
        claims[channel] = single or called or [
            one for one in fields
            if not one.meaning.channels and not one.meaning.is_other and not one.meaning.is_wanted
            and (unit := unit_named(one.field.unit)) is not None and unit.si == si_of(channel)
            and not (channel == "spool" and unit.si == "A" and any(c == "current" for c in claims))
        ]  # fmt: skip
    return claims


def _of_channel(channel: str, claims: Mapping[str, list[MeantField]], both: bool) -> Reading | Question | None:
    """The certain reading of a channel, or the question about it."""
    fields = claims[channel]
    if channel == "voltage_command" and (pair := _one_sided(fields)) is not None:
        return pair
    readings = [reading for one in fields for reading in readings_of(channel, one)]
    if not readings:
        return None
    alone = len(fields) == 1 and len(readings) == 1
    others = sorted({other for other in claims if other != channel and any(one in claims[other] for one in fields)})
    if channel == "force" and both:
        return Question(channel, f"{_names(fields)}: {_IN_PLACE}", (*readings, None))
    meaning = fields[0].meaning
    if alone and not others and meaning.channels == {channel} and meaning.is_sure and readings[0].is_certain:
        return readings[0]
    text = f"{_names(fields)}: {_text(channel, fields, readings, others)}"
    is_maybe_none = bool(others) or len(fields) > 1 or not meaning.is_sure or meaning.channels != {channel}
    return Question(channel, text, (*readings, None) if is_maybe_none else tuple(readings))


def _one_sided(fields: Sequence[MeantField]) -> Question | None:
    """The question about a command of two one-sided columns; None where the fields are not such columns."""
    if (
        len(fields) != 2
        or {one.meaning.side for one in fields} != {1, -1}
        or len({one.field.unit for one in fields}) > 1
    ):
        return None
    if any(one.field.low < -_ONE_SIDED * one.field.high for one in fields):
        return None
    first, second = sorted(fields, key=lambda one: -one.meaning.side)
    ways = []
    for plus, minus in ((first, second), (second, first)):
        ways += [replace(reading, minus=minus.field) for reading in readings_of("voltage_command", plus)]
    text = (
        f"{_names((first, second))}: one command of two sides? {first.field.path!r} less {second.field.path!r} is the"
        f" first answer, the other way round the second; {_calibration('voltage_command', first.field, ways)}"
    )
    return Question("voltage_command", text, (*ways, None))


def _names(fields: Sequence[MeantField]) -> str:
    return ", ".join(f'"{f"{one.field.topic} {one.field.path}".strip()}"' for one in fields)


def _text(channel: str, fields: Sequence[MeantField], readings: Sequence[Reading], others: Sequence[str]) -> str:
    """The question in a line, without the fields' names."""
    field = fields[0].field
    if len(fields) > 1:
        return f"which of these is {channel}?"
    span = f"it goes from {field.low:.4g} to {field.high:.4g}{' ' + field.unit if field.unit else ''}"
    if any(reading.points for reading in readings):
        maybe = f"is it {channel} or {' or '.join(others)}? " if others else ""
        return f"{maybe}{_calibration(channel, field, readings)} {span}"
    if not field.unit and len({reading.unit for reading in readings}) == 1:
        return f"is {channel} in {readings[0].unit}? {span}"
    if others:
        return f"is it {channel} or {' or '.join(others)}? {span}"
    if len({reading.unit for reading in readings}) > 1:
        return f"in which unit is {channel}? {span}"
    if len({reading.reference for reading in readings}) > 1:
        return f"is {channel} absolute or gauge? {span}"
    return f"is this {channel}? {span}"


def _calibration(channel: str, field: Field, readings: Sequence[Reading]) -> str:
    """The question about the points of a sensor."""
    reading = next(one for one in readings if one.points)
    raw = " and at ".join(f"{place:g}" for place, _ in reading.points)
    what = channel.replace("_", " ").replace("pressure a", "pressure A").replace("pressure b", "pressure B")
    return f"{what} [{reading.unit}] at {raw} {field.unit or 'as recorded'}{reading.hint}?"


def _open_questions(
    fields: Sequence[MeantField], certain: Sequence[Reading], questions: Sequence[Question]
) -> list[Question]:
    """The questions about usual channels that no field is named, with the fields without a meaningful name or unit."""
    asked = [reading.field for question in questions for reading in question.readings if reading is not None]
    taken = [*asked, *(reading.field for reading in certain)]
    nameless = [
        one for one in fields
        if one.field not in taken and not one.field.unit and one.field.low < one.field.high and not one.meaning.channels
        and not one.meaning.is_wanted and not one.meaning.is_other
    ][:MOST_UNNAMED]  # fmt: skip
    have = {reading.channel for reading in certain} | {question.channel for question in questions}
    if not have & {"position", "pressure_a", "pressure_b"}:
        cards = [one for one in fields if _is_of_a_card(one)]
        nameless += cards[:MOST_UNNAMED] if len(cards) > 1 else []
    found = []
    for channel in _USUAL_CHANNELS if nameless else ():
        if channel in have:
            continue
        readings = [reading for one in nameless for reading in readings_of(channel, one, any_range=False)]
        if readings:
            found.append(Question(channel, f"which number is {channel}, if any?", (*readings, None), True))
    return found


def _is_of_a_card(one: MeantField) -> bool:
    """Whether a field without a meaningful name may be the raw number of a measuring card or a sensor."""
    unit, meaning = unit_named(one.field.unit), one.meaning
    tells = meaning.channels or meaning.is_wanted or meaning.is_other
    return not tells and unit is not None and unit.si in ("V", "A", "%", "counts")


def used(suggestions: Suggestions) -> Mapping[tuple[str, str], list[str]]:
    """The channels that each field may be, by the field's topic and path."""
    found: dict[tuple[str, str], list[str]] = {}
    readings = [*suggestions.certain, *(reading for question in suggestions.questions for reading in question.readings)]
    for reading in readings:
        for field in (reading.field, reading.minus) if reading is not None else ():
            if reading is not None and field is not None:
                channels = found.setdefault((field.topic, field.path), [])
                if reading.channel not in channels:
                    channels.append(reading.channel)
    return found


def rate_of(inspection: Inspection, suggestions: Suggestions) -> float:
    """Rows per second of a table whose time is certain; NaN for others."""
    time = next((reading for reading in suggestions.certain if reading.channel == "time"), None)
    if time is None:
        return inspection.rate if inspection.rate is not None and not _asks_time(suggestions) else nan
    if time.rate is not None:
        return time.rate
    unit = unit_named(time.unit or "s")
    return (
        1.0 / (time.field.step * unit.scale) if unit and not isnan(time.field.step) and time.field.step > 0.0 else nan
    )


def _asks_time(suggestions: Suggestions) -> bool:
    return any(question.channel == "time" for question in suggestions.questions)


def rule_of(reading: Reading) -> ChannelRule:
    """A reading as a topics file's rule."""
    field = reading.field
    return ChannelRule(
        topic=field.topic or None, field=field.path if field.topic else None,
        column=None if field.topic or not field.path else field.path,
        scale=1.0, reference=reading.reference, unit=reading.unit, points=reading.points,
        minus=reading.minus.path if reading.minus else None,
        time=field.time or None if reading.channel != "time" else None,
        rate=reading.rate, day_first=reading.day_first, assumed=reading.assumed if reading.is_certain else "",
    )  # fmt: skip
