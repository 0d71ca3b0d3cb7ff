"""Parameters that differ between recordings of one rig: a load, a supply pressure.

In a model of several recordings `name` is the first one's value, `name@2`, `name@3` are those of the others. Parameters
that are not marked as per recording have one value for all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from eha_core.identification.free_parameters import FreeParameter


def named(name: str, number: int) -> str:
    """A parameter's name in the recording of that number, counted from one."""
    return name if number == 1 else f"{name}@{number}"


def base_name(name: str) -> str:
    """The parameter's name without the recording's number."""
    return name.partition("@")[0]


def values_of(values: Mapping[str, float], number: int) -> Mapping[str, float]:
    """Every parameter's value in the recording of that number."""
    if not any("@" in name for name in values):
        return values
    return {name: values.get(named(name, number), value) for name, value in values.items() if "@" not in name}


def in_each(
    free: Sequence[FreeParameter], values: Mapping[str, float], marked: Iterable[str], recordings: int
) -> tuple[tuple[FreeParameter, ...], dict[str, float]]:
    """Free parameters and values, with one more of each marked parameter for each further recording.

    The initial guess is the first recording's value. A parameter that is not marked has no values of its own.
    """
    known = {parameter.name for parameter in free}
    wanted = frozenset(marked)
    more: list[FreeParameter] = []
    begun = {name: value for name, value in values.items() if base_name(name) in wanted or "@" not in name}
    for parameter in free:
        for number in range(2, recordings + 1 if parameter.name in wanted else 2):
            name = named(parameter.name, number)
            begun.setdefault(name, begun[parameter.name])
            if name not in known:
                more.append(replace(parameter, name=name))
    return (*free, *more), begun


def is_one_of(name: str, names: Iterable[str]) -> bool:
    """Whether a name is one of these in any recording."""
    return base_name(name) in names
