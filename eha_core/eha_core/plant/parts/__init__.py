"""What an actuator is put together from: one file a source, a cylinder or a load.

A file added to `sources`, `cylinders` or `loads` is found; there is no list to edit. Each holds a docstring, its
declaration `PART` and, of a source, one compiled `contribution`: the flows at the ports. A cylinder or a load says by
its declaration which places of the equations its parameters take.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType

from eha_core.errors import ParameterError, remedy
from eha_core.plant.parts.declaration import Cylinder, Load, Part, Source

__all__ = ["FOLDERS", "Cylinder", "Load", "Part", "Source", "part", "parts"]

FOLDERS = {"source": "sources", "cylinder": "cylinders", "load": "loads"}
"""The folder of each kind of part."""


@cache
def parts(kind: str) -> Mapping[str, Part]:
    """The parts of a kind ("source", "cylinder" or "load") by id."""
    package = import_module(f"{__name__}.{FOLDERS[kind]}")
    found = {
        entry.name: replace(import_module(f"{package.__name__}.{entry.name}").PART, id=entry.name)
        for entry in iter_modules(package.__path__)
    }
    return MappingProxyType(found)


def part(kind: str, name: object) -> Part:
    """A part by kind and id; ParameterError where there is none."""
    found = parts(kind).get(str(name))
    if found is None:
        raise ParameterError(f"plant.{kind} = {name} is unknown; {remedy(str(name), parts(kind))}")
    return found
