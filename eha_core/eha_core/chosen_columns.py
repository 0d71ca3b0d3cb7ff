"""A file's columns as a user names them: is it there, may it be another one, in which unit is it; with the remedy."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from eha_core.errors import EhaError, remedy
from eha_core.unit_names import UNITS, Unit, unit_named


def required(source: str, names: Iterable[str], name: str, option: str) -> str:
    """The column of that name. Raises EhaError where there is none."""
    have = list(names)
    if name not in have:
        cure = remedy(name, have, f"it has {', '.join(have)}")
        raise EhaError(f"{source}: has no column {name!r} for {option}; {cure}")
    return name


def the_only(source: str, names: Sequence[str], what: str, option: str) -> str | None:
    """The only one of some columns; None without any. Raises EhaError where there are several."""
    if len(names) > 1:
        raise EhaError(f"{source}: {' and '.join(names)} may be the {what}; choose one with {option} COLUMN")
    return names[0] if names else None


def unit_among(source: str, name: str, unit: Unit | None, allowed: Sequence[str], example: str) -> Unit:
    """The unit of a column, of one of the `allowed` SI units. Raises EhaError where it is not known, or of another
    quantity."""
    cure = f"give --unit '{name}={example}'"
    if unit is None:
        raise EhaError(f"{source}: column {name!r} has no unit; {cure}")
    if unit.si not in allowed:
        raise EhaError(
            f"{source}: column {name!r} is in {unit.si}, not in {' or '.join(allowed)}; choose another column,"
            f" or {cure}"
        )
    return unit


def stated_units(units: Mapping[str, str], example: str) -> dict[str, Unit]:
    """The units of --unit, by column. Raises EhaError where one is none."""
    found = {}
    for name, text in units.items():
        if (unit := unit_named(text)) is None:
            cure = remedy(text, UNITS, f"write for example {example}")
            raise EhaError(f"--unit {name}={text}: {text} is no unit; {cure}")
        found[name] = unit
    return found
