"""Where each channel is found: the default topics, and the topics file that says otherwise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite
from pathlib import Path
from typing import Any

from eha_core.errors import RecordingError, remedy
from eha_core.recording.recording import CHANNEL_KINDS
from eha_core.unit_names import UNITS, Unit, unit_named
from eha_core.yaml_file import load_yaml

ABSOLUTE, GAUGE = "absolute", "gauge"


@dataclass(frozen=True)
class ChannelRule:
    """How one channel is taken from a topic's field or a table's column: value = scale * raw + offset.

    Attributes:
        topic: full topic name; None where the channel's default topic serves.
        field: path inside the message, for example `position[0]`; None where the default field serves.
        column: a table's column; None where it is named like the channel.
        scale: factor to SI units.
        offset: added after scaling [SI unit].
        reference: for pressures, "absolute" or "gauge"; None where nothing was said, which counts as absolute.
        unit: the unit that was named, which `scale` and `reference` already stand for.
    """

    topic: str | None = None
    field: str | None = None
    column: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    reference: str | None = None
    unit: str | None = None


@dataclass(frozen=True)
class TopicsFile:
    """A topics file as read: rules by channel name (None leaves a channel out) and the namespace to look in."""

    channels: Mapping[str, ChannelRule | None]
    namespace: str | None = None
    time: ChannelRule = ChannelRule()


DEFAULT_RULES: dict[str, ChannelRule] = {
    "voltage_command": ChannelRule("voltage_command", "data"),
    "position": ChannelRule("joint_states", "position[piston]"),
    "velocity": ChannelRule("joint_states", "velocity[piston]"),
    "pressure_a": ChannelRule("chamber_a/pressure", "fluid_pressure", reference=ABSOLUTE),
    "pressure_b": ChannelRule("chamber_b/pressure", "fluid_pressure", reference=ABSOLUTE),
    "force": ChannelRule("joint_states", "effort[piston]"),
}
"""The contract's relative topics; `[piston]` is the joint of that name, or the only one."""

STATE_RULES: dict[str, ChannelRule] = {
    "voltage_command": ChannelRule("state", "voltage"),
    "position": ChannelRule("state", "measured_position"),
    "velocity": ChannelRule("state", "measured_velocity"),
    "pressure_a": ChannelRule("state", "measured_pressure_a", reference=GAUGE),
    "pressure_b": ChannelRule("state", "measured_pressure_b", reference=GAUGE),
}
"""Taken from the simulator's logging topic where nothing else was recorded: its sensors' values, not its truth."""


def load_topics_file(path: str | Path) -> TopicsFile:
    """Read a topics file.

    Raises:
        RecordingError: the file is missing, is no YAML, or names an unknown channel or key.
    """
    content = load_yaml(path, RecordingError, f"topics file {path}")
    if not isinstance(content, dict) or not isinstance(content.get("channels"), dict):
        raise RecordingError(f"topics file {path}: needs `channels:` with one entry for each channel")
    _refuse_unknown(path, "key", content, ("channels", "namespace"))
    _refuse_unknown(path, "channel", content["channels"], (*CHANNEL_KINDS, "time"))
    rules = {name: _rule(path, name, entry) for name, entry in content["channels"].items()}
    namespace = content.get("namespace")
    return TopicsFile(
        {name: rule for name, rule in rules.items() if name != "time"},
        None if namespace is None else str(namespace).strip("/"),
        rules.get("time") or ChannelRule(),
    )


def _refuse_unknown(path: str | Path, what: str, given: Mapping[Any, Any], known: tuple[str, ...]) -> None:
    for name in given:
        if name not in known:
            raise RecordingError(f"topics file {path}: unknown {what} {name!r}; known are {', '.join(known)}")


def _rule(path: str | Path, channel: str, entry: Any) -> ChannelRule | None:
    if entry is None:
        return None
    where = f"topics file {path}: channel {channel}"
    if not isinstance(entry, dict):
        raise RecordingError(f"{where}: needs keys such as {{topic: /name, field: data}}")
    _refuse_unknown(path, f"key of {channel}", entry, tuple(row.name for row in fields(ChannelRule)))
    values = dict(entry)
    for name in ("scale", "offset"):
        if name in values:
            try:
                values[name] = float(values[name])
            except (TypeError, ValueError, OverflowError):
                raise RecordingError(f"{where}: {name} {values[name]!r} is no number") from None
            if not isfinite(values[name]) or (name == "scale" and values[name] == 0.0):
                raise RecordingError(f"{where}: {name} {values[name]:g} makes no numbers of what was recorded")
    if values.get("reference") not in (None, ABSOLUTE, GAUGE):
        raise RecordingError(f"{where}: reference {values['reference']!r}; say {ABSOLUTE} or {GAUGE}")
    for name in ("topic", "field", "column", "unit"):
        if values.get(name) is not None:
            values[name] = str(values[name])
    if "unit" in values and "scale" in values:
        raise RecordingError(f"{where}: unit and scale say the same thing; keep one")
    if values.get("unit") is not None:
        unit = _unit_of(where, channel, values["unit"])
        values["scale"] = unit.scale
        values.setdefault("reference", unit.reference)
    return ChannelRule(**values)


def _unit_of(where: str, channel: str, text: str) -> Unit:
    """The unit that a topics file says of a channel.

    Raises:
        RecordingError: it is no unit, or one of another quantity.
    """
    si = "s" if channel == "time" else CHANNEL_KINDS[channel].unit
    fitting = [name for name, unit in UNITS.items() if unit.si == si]
    unit = unit_named(text)
    if unit is None:
        raise RecordingError(f"{where}: unit {text!r} is not known; {remedy(text, fitting)}")
    if unit.si != si:
        raise RecordingError(f"{where}: {text} is no unit of it, which is in {si}; choose {', '.join(fitting)}")
    return unit
