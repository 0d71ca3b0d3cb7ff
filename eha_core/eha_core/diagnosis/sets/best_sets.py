"""The best sets of every size in a quadratic model: a beam that grows and shrinks until no set of any size improves."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.compiled import compiled
from eha_core.diagnosis.criteria import BEAM
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.sets.quadratic import Option, QuadraticModel
from eha_core.identification.numbers import Array, Flags, Integers


@dataclass(frozen=True)
class Proposal:
    """A set as options of the quadratic model, and the objective that it predicts."""

    options: tuple[Option, ...]
    predicted: float


def best_sets(model: QuadraticModel, most: int) -> Mapping[int, list[Proposal]]:
    """For each size up to `most` (see Hypothesis.size) the best sets, the best first."""
    options = model.options
    table = _table(options)
    rivals = _exclusive(options)
    sizes = [option.member.size for option in options]
    levels: list[dict[tuple[int, ...], float]] = [{} for _ in range(most + 1)]
    levels[0][()] = 0.0
    present = tuple(k for k, option in enumerate(options) if option.present)
    _add(levels, sizes, present, _gain(model, table, present))
    expanded: set[tuple[int, ...]] = set()
    while True:
        leading = [sorted(level, key=level.__getitem__, reverse=True)[:BEAM] for level in levels]
        fresh = [chosen for level in leading for chosen in level if chosen not in expanded]
        if not fresh:
            break
        for chosen in fresh:
            expanded.add(chosen)
            allowed = ~np.any(rivals[list(chosen)], axis=0)
            gains = _extended(model.matrix, model.gradient, model.one_way, table, np.array(chosen, np.int64), allowed)
            for k in np.argsort(gains)[::-1][: 2 * BEAM]:
                _add(levels, sizes, tuple(sorted((*chosen, int(k)))), float(gains[k]))
            for k in chosen:
                smaller = tuple(other for other in chosen if other != k)
                if smaller not in levels[sum(sizes[other] for other in smaller)]:
                    _add(levels, sizes, smaller, _gain(model, table, smaller))
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
    options = model.options
    table = _table(options)
    kept = tuple(k for k, option in enumerate(options) if option.present and option.member not in members)
    return model.empty - _gain(model, table, kept)


def one_more(model: QuadraticModel) -> list[Proposal]:
    """The set about which the model was made, with each option more that gains anything."""
    options = model.options
    table = _table(options)
    present = tuple(k for k, option in enumerate(options) if option.present)
    allowed = np.array([not option.present for option in options], dtype=np.bool_)
    gains = _extended(model.matrix, model.gradient, model.one_way, table, np.array(present, np.int64), allowed)
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


def _gain(model: QuadraticModel, table: Integers, chosen: tuple[int, ...]) -> float:
    if not chosen:
        return 0.0
    allowed = np.zeros(len(table), dtype=np.bool_)
    allowed[chosen[-1]] = True
    rest = np.array(chosen[:-1], np.int64)
    return float(_extended(model.matrix, model.gradient, model.one_way, table, rest, allowed)[chosen[-1]])


@compiled
def _extended(
    matrix: Array, gradient: Array, one_way: Integers, table: Integers, chosen: Integers, allowed: Flags
) -> Array:
    """What a set gains over the empty one with each allowed option more; -1 where a coefficient has the wrong sign."""
    width = table.shape[1]
    room = (len(chosen) + 1) * width
    places = np.empty(room, np.int64)
    lower = np.zeros((room, room))
    z = np.zeros(room)
    count = 0
    for option in chosen:
        for w in range(width):
            if table[option, w] >= 0:
                places[count] = table[option, w]
                count += 1
    gains = np.full(len(table), -1.0)
    base = 0.0
    for row in range(count):
        for column in range(row + 1):
            total = matrix[places[row], places[column]]
            for k in range(column):
                total -= lower[row, k] * lower[column, k]
            if column < row:
                lower[row, column] = total / lower[column, column]
            else:
                if total <= 1e-12:
                    return gains
                lower[row, row] = np.sqrt(total)
        total = gradient[places[row]]
        for k in range(row):
            total -= lower[row, k] * z[k]
        z[row] = total / lower[row, row]
        base += z[row] * z[row]
    x = np.zeros(room)
    for option in range(len(table)):
        if not allowed[option]:
            continue
        size, gain, sound = count, base, True
        for w in range(width):
            place = table[option, w]
            if place < 0:
                continue
            places[size] = place
            for column in range(size + 1):
                total = matrix[place, places[column]]
                for k in range(column):
                    total -= lower[size, k] * lower[column, k]
                if column < size:
                    lower[size, column] = total / lower[column, column]
                elif total <= 1e-12:
                    sound = False
                else:
                    lower[size, size] = np.sqrt(total)
            if not sound:
                break
            total = gradient[place]
            for k in range(size):
                total -= lower[size, k] * z[k]
            z[size] = total / lower[size, size]
            gain += z[size] * z[size]
            size += 1
        if not sound:
            continue
        for row in range(size - 1, -1, -1):
            total = z[row]
            for k in range(row + 1, size):
                total -= lower[k, row] * x[k]
            x[row] = total / lower[row, row]
            if one_way[places[row]] * x[row] < 0.0:
                sound = False
                break
        if sound:
            gains[option] = gain
    return gains
