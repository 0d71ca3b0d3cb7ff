"""Places that follow each other at one interval: the mark of a slower rate in a channel of a higher one."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import percentile_filter

from eha_core.health.noise import Integers
from eha_core.health.signal import covered

IN_A_ROW = 12
"""Intervals of one length in a row that are no chance: of samples that differ or not by chance, less than one in two
intervals is the usual one, and so many in a row come up once in 1e6 rows (0.5 ** 12 of 1 in 250 samples)."""
MOST = 6
"""Usual intervals in one, where moments in between left no mark."""
LARGE = 6
"""Samples of an interval from which on it may be one more or less: a rate that is no whole part of the other."""


def regular(places: Integers, shortest: int = 2) -> list[tuple[int, int, float]]:
    """The stretches of `places` that follow at one interval: first and last of them, and the interval [samples]."""
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
    """The usual interval; one that is passed over now and then counts for nothing."""
    usual = float(np.median(intervals))
    return float(np.mean(intervals[np.abs(intervals - usual) <= 1]))
