"""Effects that cannot be distinguished: another one explains nearly all of their response."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from eha_core.diagnosis.criteria import TIE
from eha_core.diagnosis.detection.responses import Responses
from eha_core.diagnosis.result import Confusion
from eha_core.diagnosis.search.columns import Column


def confusions(columns: Sequence[Column], seen: Responses) -> list[tuple[Confusion, ...]]:
    """For each column, the other effects that explain its response up to TIE at a size within their bounds, the best
    first."""
    groups: dict[str, list[int]] = {}
    for place, column in enumerate(columns):
        if seen.usable[place]:
            groups.setdefault(column.effect.id, []).append(place)
    return [
        tuple(sorted(_of_one(place, columns, seen, groups), key=lambda rival: rival.left))
        for place in range(len(columns))
    ]


def _of_one(
    place: int, columns: Sequence[Column], seen: Responses, groups: dict[str, list[int]]
) -> Iterator[Confusion]:
    energy = seen.left(place)
    if not seen.usable[place] or energy <= 0.0:
        return
    for rival, places in groups.items():
        if rival == columns[place].effect.id:
            continue
        left = seen.left(place, places)
        if left < TIE:
            yield Confusion(rival, left, max(1.0 - left / energy, 0.0) ** 0.5)
