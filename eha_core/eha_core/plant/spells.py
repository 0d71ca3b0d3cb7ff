"""The time in which the catalogue's effects act, and steps cut where it begins and ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import NamedTuple


class Spell(NamedTuple):
    """Steps in a row that the effects act in, or do not: which steps, how many make a row, and which rows they fill."""

    steps: slice
    every: int
    rows: slice
    acting: bool


def span(values: Mapping[str, float], step_size: float) -> tuple[int, int]:
    """The first step in which the effects act, and the first in which they no longer do."""
    return round(values["effects_from"] / step_size), round(values["effects_until"] / step_size)


def spells(first: int, count: int, every: int, acting: tuple[int, int]) -> Iterator[Spell]:
    """Cut `count` steps, the first of them step `first` of the record, where the effects begin and cease to act.

    Steps and rows are counted from the first. Every `every`-th step fills a row, wherever the cuts lie.
    """
    cuts = sorted({0, count, *(instant - first for instant in acting if 0 < instant - first < count)})
    for begin, end in pairwise(cuts):
        acts = acting[0] <= first + begin < acting[1]
        whole = min(-(-begin // every) * every, end)
        if begin < whole:  # the row that the last spell began
            fills = whole % every == 0
            row = whole // every
            yield Spell(slice(begin, whole), whole - begin + (not fills), slice(row - fills, row), acts)
        if whole < end:
            yield Spell(slice(whole, end), every, slice(whole // every, end // every), acts)
