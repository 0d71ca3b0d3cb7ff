"""Which columns of a step test are the time, the command and the motion: by units and names, or as chosen."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from eha_core.chosen_columns import required, the_only, unit_among
from eha_core.errors import EhaError
from eha_core.recording.column_names import Meaning, meaning_of, words_of
from eha_core.step_tests.result import Array
from eha_core.unit_names import Unit

COMMAND_UNITS = ("%", "V", "A", "Pa")
"""SI units of a command, the likelier first: a measured current only follows the command."""

POSITION_UNITS, VELOCITY_UNITS = ("m", "rad"), ("m/s", "rad/s")

_PILOT_WORDS = frozenset(("pilot", "vorsteuer", "vorsteuerdruck", "steuerdruck", "pilotage", "pilotaje"))
_EXAMPLES = {"%": "%", "m": "mm"}


@dataclass(frozen=True)
class Selection:
    """Columns and units as a user says them; what is not said is recognised.

    Attributes:
        command, motion, time: columns, or of messages channels.
        units: by column, its unit where its name states none. A channel is relabelled, its numbers stay.
        topics: a topics file for recordings of messages.
    """

    command: str | None = None
    motion: str | None = None
    time: str | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    topics: str | Path | None = None


@dataclass(frozen=True)
class Columns:
    """Named columns of one file.

    Attributes:
        source: the file's name.
        units: by column, its unit; None where it is not known.
        series: the instants [s] and the numbers of a column.
        remarks: what was left out when the file was read.
    """

    source: str
    units: Mapping[str, Unit | None]
    series: Callable[[str], tuple[Array, Array]]
    remarks: tuple[str, ...] = ()

    def require(self, name: str, option: str) -> str:
        """The column of that name. Raises EhaError where there is none."""
        return required(self.source, self.units, name, option)

    def unit(self, name: str, allowed: Sequence[str]) -> Unit:
        """The unit of a column. Raises EhaError where it is not known, or of another quantity."""
        return unit_among(self.source, name, self.units[name], allowed, _EXAMPLES[allowed[0]])


def time_column(names: Sequence[str]) -> str | None:
    """The first column that is named like a time; None without one."""
    timed = [name for name in names if name == "time" or meaning(name).channels == {"time"}]
    return timed[0] if timed else None


def command_column(columns: Columns, selection: Selection) -> str:
    """The command. Raises EhaError where none or several columns may be it."""
    if selection.command is not None:
        return columns.require(selection.command, "--command")
    named = [name for name in columns.units if _is_command(name, columns.units[name])]
    ranked = [*(_of_unit(columns, named, si) for si in COMMAND_UNITS), _without_unit(columns, named),
              *(_of_unit(columns, _nameless(columns), si) for si in COMMAND_UNITS[:3])]  # fmt: skip
    return _only(columns, ranked, "command", "--command")


def motion_column(columns: Columns, selection: Selection) -> str:
    """The motion. Raises EhaError where none or several columns may be it."""
    if selection.motion is not None:
        return columns.require(selection.motion, "--motion")
    ranked = []
    for channel, units in (("position", POSITION_UNITS), ("velocity", VELOCITY_UNITS)):
        named = [name for name in columns.units if _is_measured(name, channel)]
        ranked += [[name for si in units for name in _of_unit(columns, named, si)], _without_unit(columns, named)]
    ranked += [_of_unit(columns, _nameless(columns), si) for si in (*POSITION_UNITS, *VELOCITY_UNITS)]
    return _only(columns, ranked, "position, angle or velocity", "--motion")


def meaning(name: str) -> Meaning:
    """What a column's name means, without the unit in its brackets."""
    return meaning_of(name.partition("[")[0].partition("(")[0])


def _is_command(name: str, unit: Unit | None) -> bool:
    if unit is not None and unit.si == "Pa":
        return bool(_PILOT_WORDS & set(words_of(name)))
    return bool(meaning(name).channels & {"voltage_command", "current"})


def _is_measured(name: str, channel: str) -> bool:
    found = meaning(name)
    return found.channels == {channel} and not found.is_wanted


def _nameless(columns: Columns) -> list[str]:
    """Columns whose names mean nothing."""
    means = {name: meaning(name) for name in columns.units}
    return [name for name, one in means.items() if not (one.channels or one.is_other or one.is_wanted)]


def _of_unit(columns: Columns, names: Iterable[str], si: str) -> list[str]:
    return [name for name in names if (unit := columns.units[name]) is not None and unit.si == si]


def _without_unit(columns: Columns, names: Iterable[str]) -> list[str]:
    return [name for name in names if columns.units[name] is None]


def _only(columns: Columns, ranked: Iterable[list[str]], what: str, option: str) -> str:
    """The column of the first rank that has one."""
    for names in ranked:
        if (name := the_only(columns.source, names, what, option)) is not None:
            return name
    have = ", ".join(columns.units) or "none"
    raise EhaError(f"{columns.source}: no column is a {what}; choose one with {option} COLUMN; it has {have}")
