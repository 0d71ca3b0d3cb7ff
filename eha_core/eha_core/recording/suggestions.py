"""Says which channel each number of a file may be: for certain, or as a question with its possible answers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isnan

from eha_core.errors import RecordingError
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE
from eha_core.recording.discovery import find_rules
from eha_core.recording.inspection import Field, Inspection
from eha_core.recording.recording import CHANNEL_KINDS
from eha_core.recording.table_file import EPOCHS, LONGEST_STEP
from eha_core.unit_names import UNITS, Unit, name_of, unit_named

_FIRST, _SECOND = "(a|1|head|cap|piston|bore|kolben|boden)", "(b|2|rod|annulus|ring|stange)"
_PRESSURE, _FLOW = "(p|pres|press|pressure|druck|fluid_pressure)", "(q|flow|volumenstrom)"
_NAMES: dict[str, str] = {
    "time": r"t|time|timestamp|stamp|zeit|x_value|seconds?|sekunden|epoch|date|datum",
    "voltage_command": r"u|u_?(valve|cmd)|valve(_?(cmd|command|voltage))?|voltage(_command)?|cmd|command|ventil",
    "current": r"i|current|coil_current|i_?(coil|valve)|strom",
    "spool": r"spool(_position)?|x_?v|x_?spool|schieber",
    "flow_a": rf"{_FLOW}_?{_FIRST}|flow_in",
    "flow_b": rf"{_FLOW}_?{_SECOND}|flow_out",
    "pressure_a": rf"(chamber_)?{_PRESSURE}_?(chamber_)?{_FIRST}|(chamber_)?{_FIRST}_{_PRESSURE}",
    "pressure_b": rf"(chamber_)?{_PRESSURE}_?(chamber_)?{_SECOND}|(chamber_)?{_SECOND}_{_PRESSURE}",
    "pump_speed": r"n|rpm|speed_pump|pump_?(speed|rpm)|drehzahl|motor_?(speed|rpm)",
    "supply_pressure": rf"{_PRESSURE}_?(s|0|supply|sys|system|pump)|(supply|system|pump)_{_PRESSURE}",
    "position": r"x|pos|position|x_?piston|piston(_position)?|stroke|displacement|weg|hub|laser|lvdt",
    "velocity": r"v|vel|velocity|speed|x_?dot|dx|v_?piston|geschwindigkeit",
    "force": r"f|force|load_?cell|kraft|effort",
}
"""Words, in English and German, by which loggers call what a channel is."""
_WANTED = re.compile(r"(^|_)(ref|reference|des|desired|target|set|setpoint|soll|err|error|demand)(_|$)")
"""What is asked for is not what is measured."""
_USUAL = {
    "Pa": (2e5, 7e7), "m": (1e-3, 5.0), "m/s": (1e-3, 10.0), "V": (1e-3, 50.0), "A": (1e-4, 10.0), "N": (10.0, 1e7),
    "m^3/s": (1e-6, 2e-2),
    "rad/s": (1.0, 2e3),
}  # fmt: skip
"""Largest magnitudes of rigs, by SI unit; they order questions, and answer none."""
_IN_PLACE = "is this to be the force of the oil on the piston, in place of both pressures?"
_USUAL_CHANNELS = ("voltage_command", "position", "pressure_a", "pressure_b", "force")
MOST_UNNAMED = 12
"""Fields without a telling name that are asked after one by one."""
_BELOW_ZERO = -2e4
"""Pa: below this a pressure is gauge; a sensor's zero is not that far off."""


@dataclass(frozen=True)
class Reading:
    """One way to read a channel: from which field, in which unit, against which pressure."""

    channel: str
    field: Field
    unit: str | None = None
    reference: str | None = None


@dataclass(frozen=True)
class Question:
    """What only somebody who knows the rig can say, and the answers that are possible.

    `is_open` marks a question after a field of which neither name nor unit says anything.
    """

    text: str
    readings: tuple[Reading, ...]
    is_open: bool = False


@dataclass(frozen=True)
class Suggestions:
    """The channels of a file: those that are certain, and questions on others; `time` is among them for a table."""

    certain: tuple[Reading, ...]
    questions: tuple[Question, ...]


def suggest(inspection: Inspection) -> Suggestions:
    """Which channels a file's numbers may be.

    A channel is certain where one field alone is called so and its unit is stated, by the file, its name or the type of
    its message; everything else is asked.
    """
    certain: list[Reading] = []
    questions: list[Question] = []
    known = _by_contract(inspection)
    taken = [reading.field for reading in known.values()]
    channels = [channel for channel in _NAMES if channel != "time" or not inspection.topics]
    claims = {channel: [field for field in _claims(channel, inspection) if field not in taken] for channel in channels}
    for channel, fields in claims.items():
        in_place = channel == "force" and all(claims[name] or name in known for name in ("pressure_a", "pressure_b"))
        if channel in known or not fields:
            certain += [known[channel]] if channel in known else []
            continue
        if in_place and known:
            continue
        others = [other for other in claims if other != channel and fields[0] in claims[other]]
        readings = [reading for field in fields for reading in _readings(channel, field)]
        is_told = len(fields) == 1 and len(readings) == 1 and not others and (fields[0].unit or channel == "time")
        if is_told and not in_place:
            certain.append(readings[0])
        else:
            text = _IN_PLACE if in_place else _text(channel, fields, readings, others)
            questions.append(Question(text, tuple(readings)))
    asked = [reading.field for question in questions for reading in question.readings]
    left = [field for field in inspection.fields if field not in taken and field not in asked and field.count]
    left = [field for field in left if not field.unit and not _called(field) and not _WANTED.search(_words(field.path))]
    left = [field for field in left if field.low < field.high and not _is_doubled(field, inspection)]
    if not (inspection.topics and known):
        questions += [
            _what_is(field) for field in left[:MOST_UNNAMED] if field not in [reading.field for reading in certain]
        ]
    return Suggestions(tuple(certain), tuple(questions))


def _what_is(field: Field) -> Question:
    """The question after a field whose name and unit say nothing: every usual channel that its range allows."""
    readings = [reading for channel in _USUAL_CHANNELS for reading in _readings(channel, field, False)]
    return Question(
        f"which channel is it, if any? it goes from {field.low:.4g} to {field.high:.4g}", tuple(readings), True
    )


def _by_contract(inspection: Inspection) -> dict[str, Reading]:
    """The channels that are found without a topics file."""
    if not inspection.topics:
        named = {field.path: field for field in inspection.fields if field.count}
        exact = {name: named[name] for name in CHANNEL_KINDS if name in named and named[name].unit in ("", _si(name))}
        sound = {name: field for name, field in exact.items() if not _is_pressure(name) or field.low > _BELOW_ZERO}
        return {name: Reading(name, field) for name, field in sound.items() if _is_usual(name, field)}
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


def _is_usual(channel: str, field: Field) -> bool:
    return max(abs(field.low), abs(field.high)) <= CHANNEL_KINDS[channel].largest


def _is_pressure(channel: str) -> bool:
    return channel in CHANNEL_KINDS and CHANNEL_KINDS[channel].is_pressure


def _si(channel: str) -> str:
    return "s" if channel == "time" else CHANNEL_KINDS[channel].unit


def _claims(channel: str, inspection: Inspection) -> list[Field]:
    """The fields that may be a channel: those called so, or where none is, those in its unit without such a name."""
    fields = [field for field in inspection.fields if field.count and _fits(channel, field)]
    fields = [field for field in fields if not _is_doubled(field, inspection)]
    # A number that is always zero is one that nobody filled in.
    fields = [field for field in fields if field.low != 0.0 or field.high != 0.0]
    called = [field for field in fields if channel in _called(field)]
    if called or channel == "time":
        return called or [field for field in fields if field.step > 0.0]
    return [field for field in fields if field.unit and not any(_fits(other, field) for other in _called(field))]


def _fits(channel: str, field: Field) -> bool:
    """Whether a field's unit and values allow a channel."""
    if channel == "time":
        return field.step > 0.0 and _has_unit(channel, field)
    return _has_unit(channel, field) and not _WANTED.search(_words(f"{field.topic}/{field.path}"))


def _has_unit(channel: str, field: Field) -> bool:
    """Whether a field's unit is of the channel's quantity, or not stated."""
    unit = unit_named(field.unit)
    return not field.unit or (unit is not None and unit.si == _si(channel))


def _is_doubled(field: Field, inspection: Inspection) -> bool:
    """Whether a field of ros2_control's introspection is in the file a second time, in the smaller messages."""
    start, _, last = field.topic.rpartition("/")
    return (
        last == "full"
        and inspection.topics.get(f"{start}/values", "").endswith("/StatisticsValues")
        and any(copy.topic == f"{start}/values" and not re.search(r"\[\d+\]", copy.path) for copy in inspection.fields)
    )


@lru_cache(maxsize=2048)
def _called(field: Field) -> frozenset[str]:
    """The channels by whose names a field is called: by the last level of its path, or else by those before."""
    if "command_interface" in field.path:
        return frozenset({"voltage_command"})
    # A message's only number is called by its topic; `data` says nothing.
    path = re.sub(r"(^|[./])(data|fluid_pressure|value)$", "", field.path)
    name = path if path and field.path != "data" else f"{field.topic}/{path}"
    name = name if field.topic else re.sub(r"\s*[\[(][^\[\]()]*[\])]\s*$", "", name)
    if field.unit and name.endswith(field.unit) and name != field.unit:
        name = name[: -len(field.unit)]
    levels = [level for level in _words(name).split("__") if level]
    for words in ("_".join(levels), "_".join(levels[-2:]), *reversed(levels)):
        found = frozenset(
            channel for channel, names in _NAMES.items() if re.fullmatch(names, words) and _has_unit(channel, field)
        )
        if found:
            return found
    return frozenset()


def _words(name: str) -> str:
    """A name in small letters, its words divided by _ and its levels by __."""
    name = re.sub(r"(?<=[a-z])(?=[A-Z0-9])", "_", name)
    return re.sub(r"[^a-z0-9_]+", "_", re.sub(r"[./\[\]]+", "__", name).lower()).strip("_")


def _readings(channel: str, field: Field, any_range: bool = True) -> list[Reading]:
    """The ways to read a field as a channel; one where nothing is open.

    Where no unit makes a rig's of its range, all of them, or none unless `any_range`.
    """
    if channel == "time":
        return _times(field)
    unit = unit_named(field.unit)
    units = [unit] if unit else _likely(channel, field, any_range)
    readings = []
    for candidate in units:
        references = _references(candidate, field) if _is_pressure(channel) else (None,)
        readings += [Reading(channel, field, name_of(candidate), reference) for reference in references]
    return readings


def _likely(channel: str, field: Field, any_range: bool) -> list[Unit]:
    fitting = [unit for unit in UNITS.values() if unit.si == _si(channel) and unit.reference is None]
    low, high = _USUAL[_si(channel)]
    largest = max(abs(field.low), abs(field.high))
    return [unit for unit in fitting if low <= largest * unit.scale <= high] or (fitting if any_range else [])


def _references(unit: Unit, field: Field) -> tuple[str | None, ...]:
    if stated := unit.reference or field.reference:
        return (stated,)
    return (GAUGE,) if field.low * unit.scale < _BELOW_ZERO else (ABSOLUTE, GAUGE)


def _times(field: Field) -> list[Reading]:
    unit = unit_named(field.unit)
    if unit is not None:
        return [Reading("time", field, name_of(unit))]
    epoch = next((name for name, (low, high) in EPOCHS.items() if low <= field.first < high), None)
    if epoch:
        return [Reading("time", field, epoch)]
    if field.step < LONGEST_STEP:
        return [Reading("time", field, "s")]
    return [Reading("time", field, unit) for unit in ("ms", "us", "ns")]


def _text(channel: str, fields: Sequence[Field], readings: Sequence[Reading], others: Sequence[str]) -> str:
    """The question in a line, without the fields' names."""
    if len(fields) > 1:
        return f"which of these is {channel}?"
    field = fields[0]
    span = f"it goes from {field.low:.4g} to {field.high:.4g}{' ' + field.unit if field.unit else ''}"
    if not field.unit and len({reading.unit for reading in readings}) == 1:
        return f"is {channel} in {readings[0].unit}? {span}"
    if others:
        return f"is it {channel} or {' or '.join(others)}? {span}"
    if len({reading.unit for reading in readings}) > 1:
        return f"in which unit is {channel}? {span}"
    if len({reading.reference for reading in readings}) > 1:
        return f"is {channel} absolute or gauge? {span}"
    return f"is this {channel}? {span}"


def used(suggestions: Suggestions) -> Mapping[tuple[str, str], list[str]]:
    """The channels that each field may be, by topic and path."""
    found: dict[tuple[str, str], list[str]] = {}
    for reading in (
        *suggestions.certain,
        *(reading for question in suggestions.questions for reading in question.readings),
    ):
        channels = found.setdefault((reading.field.topic, reading.field.path), [])
        if reading.channel not in channels:
            channels.append(reading.channel)
    return found


def rate_of(inspection: Inspection, suggestions: Suggestions) -> float:
    """Rows in a second of a table whose time is certain; NaN for others."""
    time = next((reading for reading in suggestions.certain if reading.channel == "time"), None)
    unit = unit_named(time.unit or "s") if time else None
    return 1.0 / (time.field.step * unit.scale) if time and unit and not isnan(time.field.step) else float("nan")
