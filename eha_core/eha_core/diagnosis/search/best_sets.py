"""The best sets of every size in a quadratic model: a beam that grows and shrinks until no set of any size improves."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.compiled import compiled
from eha_core.diagnosis.criteria import BEAM, BEYOND
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.search.box import within_bounds
from eha_core.diagnosis.search.quadratic import Option, QuadraticModel
from eha_core.identification.numbers import Array, Flags, Integers


@dataclass(frozen=True)
class Proposal:
    """A set as options of the quadratic model, and the objective that it predicts."""

    options: tuple[Option, ...]
    predicted: float


def best_sets(
    model: QuadraticModel, most: int, needed: float = 0.0, keeping: bool = False
) -> Mapping[int, list[Proposal]]:
    """For each size up to `most` (see Hypothesis.size) the best sets, the best first; only a little beyond the size
    that is best where each member needs to gain so much; `keeping`: only those with all members that are present."""
    options = model.options
    table = _table(options)
    rivals = _exclusive(options)
    sizes = [option.member.size for option in options]
    levels: list[dict[tuple[int, ...], float]] = [{} for _ in range(most + 1)]
    present = tuple(k for k, option in enumerate(options) if option.present)
    kept = frozenset(present if keeping else ())
    for first in (tuple(sorted(kept)), present):
        if sum(sizes[k] for k in first) <= most:
            levels[sum(sizes[k] for k in first)][first] = model.gain([options[k] for k in first])[0]
    expanded: set[tuple[int, ...]] = set()
    while True:
        leading = [sorted(level, key=level.__getitem__, reverse=True)[:BEAM] for level in levels]
        costs = [needed * size - max(level.values(), default=-np.inf) for size, level in enumerate(levels)]
        within = leading[: int(np.argmin(costs)) + BEYOND + 1]
        fresh = [chosen for level in within for chosen in level if chosen not in expanded]
        if not fresh:
            break
        for chosen in fresh:
            expanded.add(chosen)
            allowed = ~np.any(rivals[list(chosen)], axis=0)
            gains = _with_each(model, table, chosen, allowed)
            for k in np.argsort(gains)[::-1][: 2 * BEAM]:
                _add(levels, sizes, tuple(sorted((*chosen, int(k)))), float(gains[k]))
            for k in set(chosen) - kept:
                smaller = tuple(other for other in chosen if other != k)
                if smaller not in levels[sum(sizes[other] for other in smaller)]:
                    _add(levels, sizes, smaller, model.gain([options[k] for k in smaller])[0])
    return {
        size: [
            Proposal(tuple(options[k] for k in chosen), model.empty - level[chosen])
            for chosen in sorted(level, key=level.__getitem__, reverse=True)[:BEAM]
        ]
        for size, level in enumerate(levels)
        if level
    }


def _add(
    levels: Sequence[dict[tuple[int, ...], float]], sizes: Sequence[int], chosen: tuple[int, ...], gain: float
) -> None:
    """Add a set to those of its size, if it is not too large and gains anything."""
    size = sum(sizes[k] for k in chosen)
    if gain > 0.0 and size < len(levels):
        levels[size][chosen] = gain


def objective_without(model: QuadraticModel, members: Collection[Member]) -> float:
    """The objective that is predicted of the set about which the model was made, without some of its members."""
    return model.empty - model.gain([o for o in model.options if o.present and o.member not in members])[0]


def one_more(model: QuadraticModel) -> list[Proposal]:
    """The set about which the model was made, with each option more that gains anything."""
    options = model.options
    present = tuple(k for k, option in enumerate(options) if option.present)
    allowed = np.array([not option.present for option in options], dtype=np.bool_)
    gains = _with_each(model, _table(options), present, allowed)
    chosen = [options[k] for k in present]
    return [Proposal((*chosen, options[k]), model.empty - float(gain)) for k, gain in enumerate(gains) if gain > 0.0]


def _table(options: tuple[Option, ...]) -> Integers:
    """(options, most columns) the columns of each option, filled up with -1."""
    width = max([len(option.places) for option in options], default=1)
    table = np.full((len(options), width), -1, dtype=np.int64)
    for k, option in enumerate(options):
        table[k, : len(option.places)] = option.places
    return table


def _exclusive(options: tuple[Option, ...]) -> Flags:
    """(options, options) which exclude each other: the same effect, or two forms of one law."""
    ids = [option.member.id for option in options]
    kinds = [option.member.effect.kind for option in options]
    return np.array(
        [
            [ids[i] == ids[j] or (kinds[i] != "" and kinds[i] == kinds[j]) for j in range(len(ids))]
            for i in range(len(ids))
        ],
        dtype=np.bool_,
    ).reshape(len(ids), len(ids))


def _with_each(model: QuadraticModel, table: Integers, chosen: tuple[int, ...], allowed: Flags) -> Array:
    """What a set gains with each allowed option more; -1 where one of its options ends at nothing."""
    given = model.places_of([model.options[k] for k in chosen])
    absent = np.array([k for k in chosen if not model.options[k].present], dtype=np.int64)
    return _extended(
        model.matrix, model.gradient, model.lower, model.upper, table, given, absent, allowed
    )  # fmt: skip


@compiled
def _extended(
    matrix: Array, gradient: Array, lower: Array, upper: Array, table: Integers, given: Integers, absent: Integers,
    allowed: Flags,
) -> Array:  # fmt: skip
    width, count = table.shape[1], len(given)
    places = np.empty(count + width, np.int64)
    places[:count] = given
    found, moves = np.empty(count + width), np.zeros(len(gradient))
    gains = np.full(len(table), -1.0)
    for option in range(len(table)):
        if not allowed[option]:
            continue
        size = count
        for place in table[option]:
            if place >= 0:
                places[size] = place
                size += 1
        gain = within_bounds(matrix, gradient, lower, upper, places, size, found)
        moves[places[:size]] = found[:size]
        sound = _acts(moves, table[option])
        for other in absent:
            sound &= _acts(moves, table[other])
        if sound:
            gains[option] = gain
    return gains


@compiled
def _acts(moves: Array, places: Integers) -> bool:
    """Whether one of an option's moves is not nothing."""
    acts = False
    for place in places:
        if place >= 0:
            acts |= moves[place] != 0.0
    return acts
