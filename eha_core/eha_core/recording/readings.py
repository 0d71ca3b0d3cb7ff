"""The ways to read a field as a channel: its unit, the points of a sensor, the reference of a pressure."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor

from eha_core.recording.channel_kinds import CHANNEL_KINDS
from eha_core.recording.channel_rules import ABSOLUTE, GAUGE, Points
from eha_core.recording.column_names import reference_in
from eha_core.recording.field_meanings import LOOP, MeantField
from eha_core.recording.inspection import Field
from eha_core.unit_names import UNITS, Unit, name_of, unit_named

_USUAL = {
    "Pa": (2e5, 7e7), "m": (1e-3, 5.0), "m/s": (1e-3, 10.0), "V": (1e-3, 50.0), "A": (1e-4, 10.0), "N": (10.0, 1e7),
    "m^3/s": (1e-6, 2e-2),
    "rad/s": (1.0, 2e3),
}  # fmt: skip
"""Usual largest magnitudes on rigs, by SI unit; they order questions, but do not answer them."""
_BELOW_USUAL, _ABOVE_USUAL = 100.0, 2.0
"""Factors below and above these within which a stated unit is accepted: a piston may creep, but nothing is much
larger."""
BELOW_ZERO = -2e4
"""Pa; a pressure below this is gauge: a sensor's zero is not that far off."""
_ATMOSPHERE_MATTERS = 20e5
"""Pa; a pressure that reaches more is read as gauge without a question: an atmosphere is 5 % of it at most."""
_RARE = frozenset(("mbar", "kgf/cm^2", "100ns", "daN", "kgf", "m^3/h", "Hz", "deg/s", "GPa"))
"""Units that are accepted where they are stated, but never offered."""
_VALUE_UNITS = {
    "Pa": "bar", "m": "mm", "m/s": "mm/s", "V": "V", "A": "A", "N": "kN", "m^3/s": "l/min", "rad/s": "rpm",
}  # fmt: skip
"""The unit of a sensor's points in questions, by SI unit."""
_RATED_VOLTAGE = 10.0
"""V at 100 % of most proportional and servo valves with electronics of their own."""


@dataclass(frozen=True)
class Reading:
    """One way to read a channel.

    Attributes:
        channel: the channel.
        field: the field.
        unit: its unit; None where it is SI, or stated by its message.
        reference: "absolute" or "gauge" for a pressure.
        points: the characteristic of a sensor, in `unit`; None where it is still missing.
        minus: a second field that is subtracted from the first.
        rate: of the time, rows per second; NaN where it is still missing.
        day_first: of the time, whether the day is before the month in its dates; None where it does not matter.
        is_certain: whether nothing was guessed.
        assumed: what was assumed without a question, in words; empty where nothing was.
        hint: help for the answer.
    """

    channel: str
    field: Field
    unit: str | None = None
    reference: str | None = None
    points: Points = ()
    minus: Field | None = None
    rate: float | None = None
    day_first: bool | None = None
    is_certain: bool = True
    assumed: str = ""
    hint: str = ""


def si_of(channel: str) -> str:
    """A channel's SI unit."""
    return "s" if channel == "time" else CHANNEL_KINDS[channel].unit


def is_usual(channel: str, field: Field, scale: float = 1.0) -> bool:
    """Whether a field's numbers, in a unit, are within the usual range of rigs."""
    return max(abs(field.low), abs(field.high)) * scale <= CHANNEL_KINDS[channel].largest


def is_likely(channel: str, field: Field, unit: Unit) -> bool:
    """Whether a field's numbers in a stated unit are plausible for a rig; a wrong unit in a header is off by more."""
    low, high = _USUAL[si_of(channel)]
    return low / _BELOW_USUAL <= max(abs(field.low), abs(field.high)) * unit.scale <= _ABOVE_USUAL * high


def readings_of(channel: str, one: MeantField, any_range: bool = True) -> list[Reading]:
    """The ways to read a field as a channel; a single certain one where nothing is unclear.

    Where its range is plausible in no unit, all of them with `any_range`, else none.
    """
    field, si = one.field, si_of(channel)
    unit = unit_named(field.unit)
    if unit is not None and unit.si != si or _is_loop(channel, one, unit):
        if unit is not None and (through := _through_points(channel, one, unit)) is not None:
            return through
        if not one.meaning.is_word:
            return []
        unit = None  # a name takes precedence over a unit that contradicts it
    elif unit is not None and channel == "voltage_command" and one.meaning.quantity == "current":
        return []
    if unit is not None and is_likely(channel, field, unit):
        reading = _in_unit(channel, field, unit, True)
        return [reading] if reading.is_certain else [reading, *_other_reference(reading)]
    units = likely_units(channel, field, any_range)
    alone = (
        CHANNEL_KINDS[channel].is_pressure and len(units) == 1 and not field.unit and one.meaning.channels == {channel}
    )
    return [
        reading for candidate in units
        for reading in _with_references(channel, field, candidate, alone)
    ]  # fmt: skip


def likely_units(channel: str, field: Field, any_range: bool = True) -> list[Unit]:
    """The units in which a field's range is plausible for a rig."""
    si = si_of(channel)
    fitting = [unit for name, unit in UNITS.items() if unit.si == si and unit.reference is None and name not in _RARE]
    low, high = _USUAL[si]
    largest = max(abs(field.low), abs(field.high))
    return [unit for unit in fitting if low <= largest * unit.scale <= high] or (fitting if any_range else [])


def _with_references(channel: str, field: Field, unit: Unit, is_told: bool) -> list[Reading]:
    """The readings in a unit that no file states; `is_told`: its numbers allow no other unit."""
    reading = _in_unit(channel, field, unit, is_told)
    if is_told and not reading.is_certain:
        return [reading, *_other_reference(reading)]
    said = f"{name_of(unit)}, the only unit that makes a pressure of its numbers" if is_told else ""
    assumed = " and ".join(part for part in (said, reading.assumed) if part)
    return [Reading(channel, field, reading.unit, reading.reference, is_certain=is_told, assumed=assumed)]


def _in_unit(channel: str, field: Field, unit: Unit, is_certain: bool) -> Reading:
    name = name_of(unit)
    if not CHANNEL_KINDS[channel].is_pressure:
        return Reading(channel, field, name, is_certain=is_certain)
    if stated := unit.reference or field.reference or reference_in(field.path):
        return Reading(channel, field, name, stated, is_certain=is_certain)
    if field.low * unit.scale < BELOW_ZERO:
        return Reading(channel, field, name, GAUGE, is_certain=is_certain)
    if field.high * unit.scale >= _ATMOSPHERE_MATTERS:
        return Reading(channel, field, name, GAUGE, is_certain=is_certain, assumed="gauge, for want of a word on it")
    return Reading(channel, field, name, GAUGE, is_certain=False)


def _other_reference(reading: Reading) -> list[Reading]:
    return (
        [Reading(reading.channel, reading.field, reading.unit, ABSOLUTE, is_certain=False)]
        if reading.reference == GAUGE
        else []
    )


def _is_loop(channel: str, one: MeantField, unit: Unit | None) -> bool:
    """Whether a field in the channel's own unit is more likely a current loop, because its name is not a coil's."""
    if unit is None or unit.si != "A" or channel not in ("current", "spool"):
        return False
    low, high = one.field.low * unit.scale, one.field.high * unit.scale
    return low >= LOOP[0] and high <= LOOP[1] and not (channel == "current" and one.meaning.quantity == "current")


def _through_points(channel: str, one: MeantField, unit: Unit) -> list[Reading] | None:
    """The readings of a sensor's or a card's raw numbers, whose characteristic is asked for; None for other units."""
    field, si = one.field, si_of(channel)
    value = _VALUE_UNITS[si]
    reference = GAUGE if CHANNEL_KINDS[channel].is_pressure else None
    places = _places(channel, one, unit)
    if places is None:
        return None
    first, last = places
    if channel == "voltage_command" and unit.si == "%":
        points: Points = ((0.0, 0.0), (last, _RATED_VOLTAGE * last * unit.scale / 100.0))
        hint = f" ({_RATED_VOLTAGE:g} V at 100 % is usual)"
        return [Reading(channel, field, value, None, points, is_certain=False, hint=hint)]
    zero = 0.0 if unit.si in ("counts", "%") or (unit.si == "A" and first == 0.0) else None
    points = ((first, zero), (last, None))
    hint = ", through the linkage" if unit.si == "rad" else ""
    return [Reading(channel, field, value, reference, points, is_certain=False, hint=hint)]


def _places(channel: str, one: MeantField, unit: Unit) -> tuple[float, float] | None:
    """The raw numbers at the ends of a sensor's range, at which its values are asked for."""
    field = one.field
    if unit.si == "A":
        low, high = field.low * unit.scale, field.high * unit.scale
        ends = (4e-3, 20e-3) if low >= LOOP[0] and high <= LOOP[1] else (0.0, 20e-3)
        return ends[0] / unit.scale, ends[1] / unit.scale
    if unit.si == "V":
        return 0.0, 10.0 / unit.scale
    if unit.si == "%":
        return 0.0, 100.0 / unit.scale
    if unit.si == "counts":
        return 0.0, 1000.0
    if unit.si == "rad" and channel in ("position", "pump_speed"):
        step = 10.0 if unit.scale < 1.0 else 0.1
        low = floor(field.low / step) * step
        return round(low, 6), round(max(low + step, -floor(-field.high / step) * step), 6)
    if unit.si == "N m" and channel == "force":
        return 0.0, 100.0 / (unit.scale if unit.scale > 1.0 else 1.0)
    if channel == "spool" and unit.si == "m":
        return 0.0, 1e-3 / unit.scale
    return None
