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
    """The regularly spaced stretches of `places`: the first and last of each, and its interval [samples]."""
    intervals = np.diff(places)
    if len(intervals) < IN_A_ROW:
        return []
    usual = percentile_filter(intervals, 20, size=9, mode="nearest")
    fits = (intervals % np.maximum(usual, 1) == 0) | ((usual >= LARGE) & (np.abs(intervals - usual) <= 1))
    fits &= (usual >= shortest) & (intervals <= MOST * usual + 1)
    found = []
    for first, last in covered(fits):
        if last + 1 - first >= IN_A_ROW:
            found.append((first, last + 1, _interval(intervals[first : last + 1])))
    return found


def _interval(intervals: Integers) -> float:
    """The usual interval; an occasional longer one does not count."""
    usual = float(np.median(intervals))
    return float(np.mean(intervals[np.abs(intervals - usual) <= 1]))
