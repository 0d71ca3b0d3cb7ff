"""The time in which each of the catalogue's effects acts, and steps cut where one begins or ceases to."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects

NEVER = (0, 0)

Integers = NDArray[np.int64]

Spans = tuple[tuple[int, int], ...]
"""Of each effect, in the catalogue's order: the first step in which it acts, and the first in which it no longer does.
One that is switched off never acts."""


class Interval(NamedTuple):
    """Steps in a row in which the same effects act: which steps, how many make a row, which rows they fill, whether
    each effect acts, and whether it begins to with the first of them."""

    steps: slice
    every: int
    rows: slice
    acting: tuple[bool, ...]
    beginning: tuple[bool, ...]


def spans(values: Mapping[str, float], active: Sequence[bool], step_size: float) -> Spans:
    """When each effect acts, of those that are switched on (`active`, in the catalogue's order)."""
    since, until = values["effects_from"], values["effects_until"]
    found = []
    for effect, switched_on in zip(effects(), active, strict=True):
        own = [values[name] for name in effect.acting_names()] if switched_on else []
        begin, end = (max(since, own[0]), min(until, own[1])) if own else (since, until)
        found.append((round(begin / step_size), round(end / step_size)) if switched_on else NEVER)
    return tuple(found)


def instants(found: Iterable[tuple[int, int]]) -> set[int]:
    """The steps with which some effect begins or ceases to act."""
    return {step for begin, end in found if begin < end for step in (begin, end)}


class Timetable:
    """Which effects act from which step on, worked out once for the many stretches in which a record is advanced."""

    def __init__(self, found: Spans) -> None:
        self.instants = sorted(instants(found))
        self._acting = [tuple(begin <= at < end for begin, end in found) for at in (-1, *self.instants)]
        self._beginning = {at: tuple(0 < begin == at < end for begin, end in found) for at in self.instants}
        self._none = (False,) * len(found)

    def acting(self, step: int) -> tuple[bool, ...]:
        """Whether each effect acts in a step of the record."""
        return self._acting[bisect_right(self.instants, step)]

    def beginning(self, step: int) -> tuple[bool, ...]:
        """Whether each effect begins to act with a step of the record, but for those that act from its start."""
        return self._beginning.get(step, self._none)


class Piece(NamedTuple):
    """Steps in a row: which, how many make a row, and which rows they fill."""

    steps: slice
    every: int
    rows: slice


def pieces(first: int, count: int, every: int, cut_at: Iterable[int]) -> Iterator[Piece]:
    """Cut `count` steps, the first of them step `first` of the record, at these steps of the record.

    Steps and rows are counted from the first. Every `every`-th step fills a row, wherever the cuts lie.
    """
    cuts = sorted({0, count, *(instant - first for instant in cut_at if 0 < instant - first < count)})
    for begin, end in pairwise(cuts):
        whole = min(-(-begin // every) * every, end)
        if begin < whole:  # the row that the last piece began
            fills = whole % every == 0
            row = whole // every
            yield Piece(slice(begin, whole), whole - begin + (not fills), slice(row - fills, row))
        if whole < end:
            yield Piece(slice(whole, end), every, slice(whole // every, end // every))


def intervals(first: int, count: int, every: int, timetable: Timetable) -> Iterator[Interval]:
    """Cut steps, as `pieces` does, where an effect begins or ceases to act."""
    for piece in pieces(first, count, every, timetable.instants):
        at = first + piece.steps.start
        yield Interval(*piece, timetable.acting(at), timetable.beginning(at))


class Windows(NamedTuple):
    """The windows of a record, in each of which the piston begins anew: the steps `edges` (windows + 1,) at which they
    begin, and the end; what is added to the internal leakage coefficient in each (windows,); and what sensors showed
    there, position, velocity, pressure A and pressure B (windows, 4)."""

    edges: Integers
    leakage: NDArray[np.float64]
    shown: NDArray[np.float64]


FIRST, LAST, EVERY, FIRST_ROW, LAST_ROW, BEGINS, ENDS = range(7)
"""What stands in the columns of a stretch: a piece's first step and the one after its last, how many make a row, its
first row and the one after its last, and the windows that begin and end with it (-1: none)."""


def stretches(edges: Integers, every: int, instants: Sequence[int], apart: Sequence[int] = ()) -> list[Integers]:
    """Windows in a row, of which the first begins with step `edges[0]` of the record and the last ends before
    `edges[-1]`, cut as `pieces` does where an effect begins or ceases to act.

    Throughout each stretch the same effects act; a new one begins at steps that are to stand `apart`, too. A stretch is
    (pieces, 7), its columns those above; rows are counted from the record's start, and each window's begin with it.
    """
    windows = np.arange(len(edges) - 1)
    firsts, lasts = edges[:-1], edges[1:]
    steps = (firsts, lasts, np.full_like(firsts, every), firsts // every, lasts // every)
    table = np.stack([*steps, windows, windows], axis=1)
    within = set((np.searchsorted(edges, instants, side="right") - 1).tolist())
    for window in sorted(within.intersection(range(len(windows))), reverse=True):
        table = np.concatenate([table[:window], _cut(table[window], instants), table[window + 1 :]])
    borders = np.sort(np.array([*instants, *apart], dtype=np.int64))
    between = np.searchsorted(borders, table[:, FIRST], side="right")
    return np.split(table, np.flatnonzero(np.diff(between)) + 1)


def _cut(window: Integers, instants: Iterable[int]) -> Integers:
    """A window's row of a stretch as the rows of its pieces."""
    first, last, every, row, _, number, _ = window.tolist()
    cut = [
        (first + piece.steps.start, first + piece.steps.stop, piece.every, row + piece.rows.start,
         row + piece.rows.stop, -1, -1)
        for piece in pieces(first, last - first, every, instants)
    ]  # fmt: skip
    table = np.array(cut, dtype=np.int64)
    table[0, BEGINS] = table[-1, ENDS] = number
    return table
