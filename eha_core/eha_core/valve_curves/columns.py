"""The columns of a test bench's table that make a curve: by their units, by the words of their names, or as chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from eha_core.chosen_columns import required, stated_units, the_only, unit_among
from eha_core.errors import EhaError, RecordingError
from eha_core.recording.column_names import words_of
from eha_core.recording.name_words import LETTERS, OBJECTS, QUANTITIES, SIDES
from eha_core.recording.stated_units import unit_of_name
from eha_core.tables import Table, read_table
from eha_core.unit_names import Unit, unit_named
from eha_core.valve_curves.result import FLOW, LEAKAGE, PRESSURE, RESPONSE_UNITS, Array, Curve

_LEAKAGE_WORDS = frozenset(("leak", "leakage", "leckage", "leckoel", "leckstrom", "fuite", "fuga"))
_COMMAND_UNITS = ("A", "V", "%")
_COMMAND_WORDS = frozenset(("current", "voltage", "command"))
_OPTIONS = {FLOW: "--flow", PRESSURE: "--load-pressure", LEAKAGE: "--leakage"}
_EXAMPLES = {"m^3/s": "l/min", "Pa": "bar", "A": "mA"}


@dataclass(frozen=True)
class Selection:
    """Columns and units as a user says them; what is not said is recognised.

    Attributes:
        command: the column of the current, the voltage or the share of the full command.
        response: by kind of curve, its column; of a load pressure also two, pressure A and pressure B.
        units: by column, the unit that its name does not state.
    """

    command: str | None = None
    response: Mapping[str, Sequence[str]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)


class _Columns:
    """A table's columns with their units."""

    def __init__(self, source: str, table: Table, selection: Selection) -> None:
        self.source, self.table = source, table
        names = tuple(table.columns)
        stated = {name: table.units.get(name) or unit_of_name(name, names) for name in names}
        self.units: dict[str, Unit | None] = {name: unit_named(text) for name, text in stated.items()}
        given = {name: text for name, text in selection.units.items() if name in self.units}
        self.units |= stated_units(given, "l/min")

    def of_unit(self, si: str) -> list[str]:
        return [name for name, unit in self.units.items() if unit is not None and unit.si == si]

    def without_unit(self, words: frozenset[str]) -> list[str]:
        """Columns without a unit that are named so."""
        return [name for name, unit in self.units.items() if unit is None and words & _quantities(name)]

    def require(self, name: str, option: str) -> str:
        """The column of that name."""
        return required(self.source, self.table.columns, name, option)

    def one(self, names: list[str], what: str, option: str) -> str | None:
        """The only one of some columns; None where there is none."""
        return the_only(self.source, names, what, option)

    def values(self, name: str, allowed: Sequence[str]) -> Array:
        """A column in SI, or in %."""
        unit = unit_among(self.source, name, self.units[name], allowed, _EXAMPLES[allowed[0]])
        return np.asarray(self.table.columns[name], dtype=np.float64) * unit.scale


def curves_of(files: Sequence[str | Path | Mapping[str, ArrayLike]], selection: Selection) -> list[Curve]:
    """The curves of files, or of columns by name; a file of blocked ports may have pressure gain and leakage.

    Raises:
        RecordingError: a file cannot be read as a table.
        EhaError: a column or its unit is missing, or several may be meant.
    """
    tables = [_Columns(*_table(given), selection) for given in files]
    chosen = [(name, _OPTIONS[kind]) for kind, names in selection.response.items() for name in names]
    for name, option in (*chosen, *((name, "--unit") for name in selection.units)):
        if not any(name in columns.table.columns for columns in tables):
            tables[0].require(name, option)
    return [
        _curve(columns, _command(columns, selection), kind, names)
        for columns in tables
        for kind, names in _responses(columns, selection).items()
    ]


def _curve(columns: _Columns, command_name: str, kind: str, names: list[str]) -> Curve:
    source = columns.source
    command = columns.values(command_name, _COMMAND_UNITS)
    responses = [columns.values(name, (RESPONSE_UNITS[kind],)) for name in names]
    response = responses[0] if len(responses) == 1 else responses[0] - responses[1]
    if command.shape != response.shape:
        raise EhaError(
            f"{source}: {command_name} has {command.size} values and {names[0]} {response.size}; give a table with one"
            " row for each point"
        )
    whole = np.isfinite(command) & np.isfinite(response)
    remarks = [f"{np.count_nonzero(~whole)} rows without a number were left out"] if not whole.all() else []
    if not whole.any():
        raise EhaError(f"{source}: has no row with both {command_name} and {names[0]}; check its cells")
    unit = columns.units[command_name]
    return Curve(source, kind, command[whole], unit.si if unit else "", response[whole], tuple(remarks))


def _table(given: str | Path | Mapping[str, ArrayLike]) -> tuple[str, Table]:
    if isinstance(given, Mapping):
        return "columns", Table("columns", {name: np.asarray(values, float) for name, values in given.items()})
    path = Path(given)
    if not path.exists():
        raise RecordingError(f"{path}: there is no such file or folder")
    return path.name, read_table(path)


def _quantities(name: str) -> frozenset[str]:
    """The quantities that the words of a name mean; symbols count where no word does."""
    words = words_of(name)
    return frozenset(QUANTITIES[word] for word in words if word in QUANTITIES) or frozenset(
        LETTERS[word] for word in words if word in LETTERS
    )


def _command(columns: _Columns, selection: Selection) -> str:
    if selection.command is not None:
        return columns.require(selection.command, "--current")
    for names in (*map(columns.of_unit, _COMMAND_UNITS), columns.without_unit(_COMMAND_WORDS)):
        if (name := columns.one(names, "current", "--current")) is not None:
            return name
    raise EhaError(
        f"{columns.source}: no column is a current, a voltage or a command in %; choose one with --current COLUMN"
    )


def _responses(columns: _Columns, selection: Selection) -> dict[str, list[str]]:
    """The columns of each curve that a table holds: those chosen, else leakage, flow, and without a flow the pressures.

    Pressures next to a flow are those of open ports, which make no pressure gain curve.
    """
    found = {kind: list(names) for kind, names in selection.response.items()
             if names and all(name in columns.table.columns for name in names)}  # fmt: skip
    if found:
        return found
    flows = columns.of_unit("m^3/s") or columns.without_unit(frozenset(("flow",)))
    leaks = [name for name in columns.table.columns if _LEAKAGE_WORDS & set(words_of(name))]
    if (name := columns.one(leaks, "leakage", "--leakage")) is not None:
        found[LEAKAGE] = [name]
    if (name := columns.one([name for name in flows if name not in leaks], "flow", "--flow")) is not None:
        found[FLOW] = [name]
    elif pressures := _load_pressure(columns):
        found[PRESSURE] = pressures
    if not found:
        raise EhaError(
            f"{columns.source}: no column is a flow or a pressure; choose one with --flow, --load-pressure or --leakage"
        )
    return found


def _load_pressure(columns: _Columns) -> list[str]:
    """The column of the load pressure, or those of chambers A and B; supply and return pressure are none."""
    named = columns.of_unit("Pa") or columns.without_unit(frozenset(("pressure",)))
    others = {"supply", "tank", "pump"}
    named = [name for name in named if not (_objects(name) & others or _side(name) in others)]
    pair = sorted(named, key=_side)
    if [_side(name) for name in pair] == ["a", "b"]:
        return pair
    name = columns.one(named, "load pressure", "--load-pressure")
    return [] if name is None else [name]


def _objects(name: str) -> set[str]:
    return {OBJECTS[word] for word in words_of(name) if word in OBJECTS}


def _side(name: str) -> str:
    """The port that the words before the unit name: a, b, supply or tank; empty without one."""
    ports = {**SIDES, "t": "tank", "r": "tank"}
    sides = {ports[word] for word in words_of(name.partition("[")[0].partition("(")[0]) if word in ports}
    return next(iter(sides)) if len(sides) == 1 else ""
