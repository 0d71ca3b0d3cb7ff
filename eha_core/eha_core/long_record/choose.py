"""Which stretches of a long record are fitted: those that together show most of it, spread from end to end."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.long_record.limits import ENDS, NEARLY
from eha_core.long_record.survey import Shown, cells


def choose(blocks: Sequence[Shown], count: int) -> list[int]:
    """The numbers of the blocks to fit, in the order of time.

    One lies in the first tenth of the record and one in the last, so that what drifts from one end to the other is in
    the data. Each further one adds most to what is shown; of those that add nearly as much, it is the one that lies
    farthest from those chosen.
    """
    given = list(blocks)
    if len(given) <= count:
        return [block.number for block in given]
    visited = cells(given)
    beyond = NEARLY * len(frozenset().union(*visited))
    first, last = given[0].number, given[-1].number
    edge = ENDS * (last - first)
    chosen: list[int] = []
    seen: frozenset[int] = frozenset()

    def take(places: Sequence[int], origin: int | None) -> None:
        nonlocal seen
        gains = {place: len(visited[place] - seen) for place in places}
        best = max(gains.values())
        good = [place for place in places if gains[place] >= best - beyond]
        if origin is not None:  # at an end, the nearer to it the better
            place = min(good, key=lambda candidate: abs(given[candidate].number - origin))
        else:
            place = max(
                good, key=lambda candidate: min(abs(given[candidate].number - given[other].number) for other in chosen)
            )
        chosen.append(place)
        seen |= visited[place]

    take([place for place, block in enumerate(given) if block.number - first <= edge], first)
    take([place for place, block in enumerate(given) if last - block.number <= edge], last)
    while len(chosen) < count:
        take([place for place in range(len(given)) if place not in chosen], None)
    return sorted(given[place].number for place in chosen)
