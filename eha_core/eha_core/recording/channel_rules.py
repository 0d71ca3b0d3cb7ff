"""Rules for reading channels from topics or columns, and the rules of the default topics."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np

from eha_core.recording.channel_kinds import FloatArray

ABSOLUTE, GAUGE = "absolute", "gauge"
_BENT = 2
"""Points of a straight characteristic; with more it is a curve."""

Points = tuple[tuple[float, "float | None"], ...]


@dataclass(frozen=True)
class ChannelRule:
    """How one channel is read from a topic's field or a table's column: value = scale * raw + offset.

    Attributes:
        topic: full topic name; None for the channel's default topic.
        field: path inside the message, for example `position[0]`; None for the default field.
        column: a table's column; None where it has the channel's name.
        scale: factor to SI units.
        offset: added after scaling [SI unit].
        reference: for pressures, "absolute" or "gauge"; None where it is not stated, which counts as absolute.
        unit: the stated unit, which `scale` and `reference` already include.
        points: (raw, value) pairs of a sensor, in the file's numbers and in `unit`; a line through two, a smooth
            monotone curve through more; empty where raw numbers are values. An unknown value is None.
        minus: a second column, subtracted from the first: of two one-sided commands.
        time: the column of the channel's own times; None for the table's time, or the one that the file states.
        rate: of the time, rows per second of a table without times [Hz]; None where it has times, NaN where unknown.
        day_first: of the time, whether the day is before the month in ambiguous dates; None where it is not stated.
        assumed: assumptions, in words; empty where there are none.
    """

    topic: str | None = None
    field: str | None = None
    column: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    reference: str | None = None
    unit: str | None = None
    points: Points = ()
    minus: str | None = None
    time: str | None = None
    rate: float | None = None
    day_first: bool | None = None
    assumed: str = ""

    @property
    def is_open(self) -> bool:
        """Whether a number of the rule is still missing."""
        return any(value is None for _, value in self.points) or (self.rate is not None and not isfinite(self.rate))

    def in_si(self, raw: FloatArray) -> FloatArray:
        """The values [SI] of recorded numbers."""
        return np.asarray(self.scale * (self._through_points(raw) if self.points else raw) + self.offset)

    def _through_points(self, raw: FloatArray) -> FloatArray:
        places, values = (np.array([pair[k] for pair in self.points], dtype=np.float64) for k in (0, 1))
        slopes = np.diff(values) / np.diff(places)
        if len(places) <= _BENT:
            return np.asarray(values[0] + slopes[0] * (raw - places[0]))
        from scipy.interpolate import PchipInterpolator

        inside = PchipInterpolator(places, values)(np.clip(raw, places[0], places[-1]))
        beyond = slopes[0] * np.minimum(raw - places[0], 0.0) + slopes[-1] * np.maximum(raw - places[-1], 0.0)
        return np.asarray(inside + beyond)


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
"""Rules of the simulator's logging topic, used where nothing else was recorded: its sensors' values, not its states."""


def entry_text(rule: ChannelRule | None) -> str:
    """A rule as a topics file's entry on one line; missing numbers are `null`."""
    if rule is None:
        return "null"
    parts = []
    for name in ("topic", "field", "column", "minus", "time"):
        value = getattr(rule, name)
        if value is not None:
            parts.append(f"{name}: {quoted(value)}")
    if rule.points:
        pairs = ", ".join(f"[{raw:.12g}, {'null' if value is None else f'{value:.12g}'}]" for raw, value in rule.points)
        parts.append(f"points: [{pairs}]")
    if rule.rate is not None:
        parts.append(f"rate: {f'{rule.rate:.12g}' if isfinite(rule.rate) else 'null'}")
    if rule.day_first is not None:
        parts.append(f"day_first: {str(rule.day_first).lower()}")
    if rule.unit is not None:
        parts.append(f"unit: {quoted(rule.unit) if not rule.unit.isalpha() else rule.unit}")
    elif rule.scale != 1.0:
        parts.append(f"scale: {rule.scale:g}")
    if rule.reference is not None:
        parts.append(f"reference: {rule.reference}")
    if rule.assumed:
        parts.append(f"assumed: {quoted(rule.assumed)}")
    return f"{{{', '.join(parts)}}}"


def quoted(text: str) -> str:
    """A text in YAML's quotes on one line, whatever a file calls its columns."""
    import yaml

    return str(yaml.safe_dump(text, default_style='"', allow_unicode=True, width=2**20)).strip()
