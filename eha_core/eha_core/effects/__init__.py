"""The catalogue of effects: every module of this package that declares an `EFFECT`.

A file added here is found; there is no list to edit. Each holds a docstring, an `EFFECT` and one compiled
`contribution` whose head is the one of its site in `eha_core.plant.hooks`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from eha_core.effects.declaration import Effect
from eha_core.effects.sites import SITES

__all__ = ["SITES", "Effect", "effect", "effect_title", "effects"]

_PROPER = {"coulomb": "Coulomb", "stribeck": "Stribeck"}


@cache
def effects() -> tuple[Effect, ...]:
    """All effects, by site, rank and id."""
    found = []
    ranks = {site: rank for rank, site in enumerate(SITES)}
    for entry in iter_modules(__path__):
        declared = getattr(import_module(f"{__name__}.{entry.name}"), "EFFECT", None)
        if declared is not None:
            found.append(replace(declared, id=entry.name))
    return tuple(sorted(found, key=lambda effect: (ranks[effect.site], effect.order, effect.id)))


def effect(identifier: str) -> Effect:
    """The effect of that id; KeyError where the catalogue has none."""
    return {entry.id: entry for entry in effects()}[identifier]


def effect_title(identifier: str) -> str:
    """An effect's id as words, with people's names in capitals."""
    return " ".join(_PROPER.get(word, word) for word in identifier.split("_"))
