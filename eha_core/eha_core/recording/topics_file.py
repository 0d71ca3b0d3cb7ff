"""Reads the topics file, which maps each channel to its source or has a question about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from math import isfinite
from pathlib import Path
from typing import Any

from eha_core.errors import RecordingError, remedy
from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, ChannelRule, Points, entry_text
from eha_core.unit_names import UNITS, Unit, unit_named
from eha_core.yaml_file import load_yaml

MOST_CANDIDATES = 3
"""Most answers to an open question that are shown in a message; the file has them all."""
OF_TIMES = ("rate", "day_first")
"""Keys of the time only."""


@dataclass(frozen=True)
class OpenQuestion:
    """An open question about a channel: its text, and the possible answers, None for no such channel."""

    text: str
    candidates: tuple[ChannelRule | None, ...]

    @property
    def likely(self) -> ChannelRule | None:
        """The first answer that needs no further number; None without one."""
        return next((one for one in self.candidates if one is not None and not one.is_open), None)


@dataclass(frozen=True)
class TopicsFile:
    """A topics file as read: rules by channel name (None leaves a channel out) and the namespace to look in.

    `remarks`: the answers assumed to open questions.
    """

    channels: Mapping[str, ChannelRule | None]
    namespace: str | None = None
    time: ChannelRule = ChannelRule()
    remarks: tuple[str, ...] = ()
    path: Path | None = field(default=None, compare=False)


def load_topics_file(path: str | Path, assume: bool = False) -> TopicsFile:
    """Read a topics file.

    Args:
        path: the file.
        assume: take the likely answers to open questions, and list them in the remarks.

    Raises:
        RecordingError: the file is missing, is not YAML, names an unknown channel or key, or has an open question.
    """
    content = load_yaml(path, RecordingError, f"topics file {path}")
    if not isinstance(content, dict) or not isinstance(content.get("channels"), dict):
        raise RecordingError(f"topics file {path}: needs `channels:` with one entry for each channel")
    _refuse_unknown(path, "key", content, ("channels", "namespace"))
    _refuse_unknown(path, "channel", content["channels"], (*CHANNEL_KINDS, "time"))
    entries = content["channels"]
    asked = {name: _question(path, name, entry) for name, entry in entries.items() if _asks(entry)}
    rules = {name: _rule(path, name, entry) for name, entry in entries.items() if name not in asked}
    answers, remarks = _answered(path, asked, assume)
    rules |= answers
    namespace = content.get("namespace")
    return TopicsFile(
        {name: rules[name] for name in entries if name != "time" and name in rules},
        None if namespace is None else str(namespace).strip("/"),
        rules.get("time") or ChannelRule(),
        (*remarks, *assumptions({name: rule.assumed for name, rule in rules.items() if rule is not None})),
        Path(path),
    )


def assumptions(by_channel: Mapping[str, str]) -> tuple[str, ...]:
    """The assumptions made without a question, one line for channels with the same one."""
    channels: dict[str, list[str]] = {}
    for channel, assumed in by_channel.items():
        if assumed:
            channels.setdefault(assumed, []).append(channel)
    return tuple(f"assumed: {' and '.join(names)} {assumed}" for assumed, names in channels.items())


def topics_of(given: str | Path | TopicsFile | None) -> TopicsFile | None:
    """A topics file, read where a path was given. Raises RecordingError as `load_topics_file`."""
    return given if isinstance(given, TopicsFile) or given is None else load_topics_file(given)


def _asks(entry: Any) -> bool:
    return isinstance(entry, dict) and "ask" in entry


def _question(path: str | Path, channel: str, entry: Mapping[str, Any]) -> OpenQuestion:
    _refuse_unknown(path, f"key of {channel}", entry, ("ask", "question"))
    candidates = entry["ask"]
    if not isinstance(candidates, list):
        raise RecordingError(f"topics file {path}: channel {channel}: `ask` needs a list of possible answers")
    rules = tuple(_rule(path, channel, one, may_be_open=True) for one in candidates)
    return OpenQuestion(str(entry.get("question") or f"which is {channel}?"), rules)


def _answered(
    path: str | Path, asked: Mapping[str, OpenQuestion], assume: bool
) -> tuple[dict[str, ChannelRule | None], tuple[str, ...]]:
    """The likely answers to open questions, and remarks on them.

    Raises:
        RecordingError: `assume` is not set, or no answer is likely.
    """
    answers: dict[str, ChannelRule | None] = {}
    remarks = []
    for channel, question in asked.items():
        likely = question.likely
        taken = [rule.column for rule in answers.values() if rule is not None]
        if likely is not None and likely.column in taken:
            others = (
                one for one in question.candidates if one is not None and not one.is_open and one.column not in taken
            )
            likely = next(others, None)
            if likely is None and None in question.candidates:
                answers[channel] = None
                continue
        if not assume or (likely is None and None not in question.candidates):
            several = f", and {len(asked) - 1} questions more" if len(asked) > 1 else ""
            shown = (
                " or ".join(entry_text(one) for one in question.candidates[:MOST_CANDIDATES]) or "an entry of its own"
            )
            likely_too = "" if likely is None else "; --assume takes the likely answers"
            raise RecordingError(
                f"topics file {path}: {question.text} Write {channel}: {shown} in place of its `ask`{several}; `eha"
                f" inspect RECORDING` asks one by one on a terminal{likely_too}"
            )
        answers[channel] = likely
        if likely is not None:
            remarks.append(f"assumed: {channel}: {entry_text(likely)} ({question.text})")
    return answers, tuple(remarks)


def _refuse_unknown(path: str | Path, what: str, given: Mapping[Any, Any], known: tuple[str, ...]) -> None:
    for name in given:
        if name not in known:
            raise RecordingError(f"topics file {path}: unknown {what} {name!r}; known are {', '.join(known)}")


def _rule(path: str | Path, channel: str, entry: Any, may_be_open: bool = False) -> ChannelRule | None:
    if entry is None:
        return None
    where = f"topics file {path}: channel {channel}"
    if not isinstance(entry, dict):
        raise RecordingError(f"{where}: needs keys such as {{topic: /name, field: data}}")
    known = [row.name for row in fields(ChannelRule) if row.name not in OF_TIMES or channel == "time"]
    _refuse_unknown(path, f"key of {channel}", entry, tuple(known))
    values = dict(entry)
    for name in ("scale", "offset"):
        if name in values:
            values[name] = _number(where, name, values[name])
            if name == "scale" and values[name] == 0.0:
                raise RecordingError(f"{where}: {name} {values[name]:g} makes no numbers of what was recorded")
    if values.get("reference") not in (None, ABSOLUTE, GAUGE):
        raise RecordingError(f"{where}: reference {values['reference']!r}; say {ABSOLUTE} or {GAUGE}")
    for name in ("topic", "field", "column", "unit", "minus", "time", "assumed"):
        if values.get(name) is not None:
            values[name] = str(values[name])
    if "points" in values:
        values["points"] = _points(where, values["points"], may_be_open)
    if not isinstance(values.get("day_first"), bool | None):
        raise RecordingError(f"{where}: day_first {values['day_first']!r}; say true or false")
    if "rate" in values:
        values["rate"] = _rate(where, values["rate"], may_be_open)
    if values.get("minus") is not None and values.get("column") is None:
        raise RecordingError(f"{where}: `minus` names a column that is taken from another; name that as `column` too")
    if "unit" in values and "scale" in values:
        raise RecordingError(f"{where}: unit and scale say the same thing; keep one")
    if values.get("unit") is not None and (channel == "time" or CHANNEL_KINDS[channel].unit):
        unit = _unit_of(where, channel, values["unit"])
        values["scale"] = unit.scale
        values.setdefault("reference", unit.reference)
    return ChannelRule(**values)


def _number(where: str, name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise RecordingError(f"{where}: {name} {value!r} is not a number") from None
    if not isfinite(number):
        raise RecordingError(f"{where}: {name} {number:g} makes no numbers of what was recorded")
    return number


def _points(where: str, given: Any, may_be_open: bool) -> Points:
    """The points of a sensor in the order of their raw numbers.

    Raises:
        RecordingError: they are not pairs of numbers, fewer than two, or one raw number has two values.
    """
    example = "write for example `points: [[4, 0], [20, 250]]`"
    if (
        not isinstance(given, list)
        or len(given) < 2
        or not all(isinstance(one, list) and len(one) == 2 for one in given)
    ):
        raise RecordingError(f"{where}: `points` needs pairs of what was recorded and what it means; {example}")
    pairs = []
    for raw, value in given:
        if value is None and not may_be_open:
            raise RecordingError(f"{where}: `points` has no value at {raw}; {example}")
        pairs.append((_number(where, "points", raw), None if value is None else _number(where, "points", value)))
    pairs.sort(key=lambda pair: pair[0])
    if len({raw for raw, _ in pairs}) < len(pairs):
        raise RecordingError(f"{where}: `points` has two values for one number; {example}")
    if all(value is not None for _, value in pairs) and len({value for _, value in pairs}) < 2:
        raise RecordingError(f"{where}: `points` has one value for all numbers; {example}")
    return tuple(pairs)


def _rate(where: str, given: Any, may_be_open: bool) -> float:
    if given is None and may_be_open:
        return float("nan")
    if given is None:
        raise RecordingError(f"{where}: `rate` has no value; write how many rows there are in a second, as `rate: 500`")
    rate = _number(where, "rate", given)
    if rate <= 0.0:
        raise RecordingError(f"{where}: rate {rate:g} is not a number of rows per second")
    return rate


def _unit_of(where: str, channel: str, text: str) -> Unit:
    """The unit that a topics file gives for a channel.

    Raises:
        RecordingError: it is not a unit, or one of another quantity.
    """
    si = "s" if channel == "time" else CHANNEL_KINDS[channel].unit
    fitting = [name for name, unit in UNITS.items() if unit.si == si]
    unit = unit_named(text)
    if unit is None:
        raise RecordingError(f"{where}: unit {text!r} is not known; {remedy(text, fitting)}")
    if unit.si != si:
        raise RecordingError(
            f"{where}: {text} is not a unit of it, which is in {si}; choose {', '.join(fitting)}, and where a sensor"
            f" gave {text} say what its numbers mean with `points`"
        )
    return unit
