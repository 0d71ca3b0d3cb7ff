"""The time in which the catalogue's effects act, and steps cut where it begins and ends."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple


class Interval(NamedTuple):
    """Steps in a row that the effects act in, or do not: which steps, how many make a row, and which rows they fill."""

    steps: slice
    every: int
    rows: slice
    acting: bool


def span(values: Mapping[str, float], step_size: float) -> tuple[int, int]:
    """The first step in which the effects act, and the first in which they no longer do."""
    return round(values["effects_from"] / step_size), round(values["effects_until"] / step_size)


class Piece(NamedTuple):
    """Steps in a row: which, how many make a row, and which rows they fill."""

    steps: slice
    every: int
    rows: slice


def pieces(first: int, count: int, every: int, instants: Iterable[int]) -> Iterator[Piece]:
    """Cut `count` steps, the first of them step `first` of the record, at these steps of the record.

    Steps and rows are counted from the first. Every `every`-th step fills a row, wherever the cuts lie.
    """
    cuts = sorted({0, count, *(instant - first for instant in instants if 0 < instant - first < count)})
    for begin, end in pairwise(cuts):
        whole = min(-(-begin // every) * every, end)
        if begin < whole:  # the row that the last piece began
            fills = whole % every == 0
            row = whole // every
            yield Piece(slice(begin, whole), whole - begin + (not fills), slice(row - fills, row))
        if whole < end:
            yield Piece(slice(whole, end), every, slice(whole // every, end // every))


def intervals(first: int, count: int, every: int, acting: tuple[int, int]) -> Iterator[Interval]:
    """Cut steps, as `pieces` does, where the effects begin and cease to act."""
    for piece in pieces(first, count, every, acting):
        yield Interval(*piece, acting[0] <= first + piece.steps.start < acting[1])
