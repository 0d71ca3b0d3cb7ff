"""Regularly spaced samples: the sign of a slower rate in a channel of a higher one."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import percentile_filter

from eha_core.health.noise import Integers
from eha_core.health.signal import covered

IN_A_ROW = 12
"""Equal intervals in a row that are not due to chance: if samples differ or not by chance, fewer than half of the
intervals have the usual length, and so many in a row occur once in 1e6 rows (0.5 ** 12 of 1 in 250 samples)."""
MOST = 6
"""Most usual intervals in one, where the changes in between were not visible."""
LARGE = 6
"""Length of an interval [samples] from which it may vary by one: a rate that does not divide the other."""


def regular(places: Integers, shortest: int = 2) -> list[tuple[int, int, float]]:
    """The regularly spaced stretches of `places`: the first and last of each, and its interval [samples].

    Where all places between two stretches of one interval are spaced by it, too, they are one, and a stretch goes on to
    an end if all places up to there are: however many of them are not visible.
    """
    intervals = np.diff(places)
    if len(intervals) < IN_A_ROW:
        return []
    usual = percentile_filter(intervals, 20, size=9, mode="nearest")
    fits = (intervals % np.maximum(usual, 1) == 0) | ((usual >= LARGE) & (np.abs(intervals - usual) <= 1))
    fits &= (usual >= shortest) & (intervals <= MOST * usual + 1)
    found: list[tuple[int, int, float]] = []
    for first, last in covered(fits):
        if last + 1 - first < IN_A_ROW:
            continue
        interval = _interval(usual[first : last + 1])
        before = found[-1] if found else (0, 0, interval)
        if abs(before[2] - interval) < 0.5 and _is_spaced(places[before[1] : first + 1], interval):
            found = [*found[:-1], (before[0], last + 1, before[2])]
        else:
            found.append((first, last + 1, interval))
    if found and _is_spaced(places[found[-1][1] :], found[-1][2]):
        found[-1] = (found[-1][0], len(intervals), found[-1][2])
    return found


def _interval(usual: Integers) -> float:
    """The shortest usual interval, or the mean of two that differ by one; a longer one skips places that are hidden."""
    return float(np.mean(usual[usual <= np.min(usual) + 1]))


def _is_spaced(places: Integers, interval: float) -> bool:
    """Whether places lie on a grid of an interval that begins at the first; a large one may vary by one."""
    steps = (places - places[0]) / interval
    off = np.abs(steps - np.round(steps)) * interval
    return bool(np.max(off) <= (1.0 if interval >= LARGE else 0.0))
