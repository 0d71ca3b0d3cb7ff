"""Puts the samples of one channel in order: stamps that increase, values that are finite, all else counted."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.recording.recording import FloatArray

_LONGEST_GAP = 3_600_000_000_000  # [ns]


@dataclass(frozen=True)
class Samples:
    """Stamps [ns] and values of one channel, as recorded or in order."""

    stamps: NDArray[np.int64]
    values: FloatArray


def put_in_order(samples: Samples) -> tuple[Samples, tuple[str, ...]]:
    """Keep the finite samples of the longest run of increasing stamps; also say what was kept out.

    A clock that jumps back costs the shorter side, a stamp that lies far ahead only itself.
    """
    remarks = []
    stamps, values = samples.stamps, samples.values
    finite = np.isfinite(values)
    if not finite.all():
        remarks.append(f"{np.count_nonzero(~finite)} samples that are no finite number were left out")
        stamps, values = stamps[finite], values[finite]
    repeated = np.zeros(len(stamps), dtype=bool)
    repeated[1:] = np.diff(stamps) == 0
    if repeated.any():
        remarks.append(f"{np.count_nonzero(repeated)} samples with the stamp of the one before were left out")
        stamps, values = stamps[~repeated], values[~repeated]
    if np.any(np.diff(stamps) < 0):
        kept = _longest_increasing(stamps)
        remarks.append(f"{len(stamps) - len(kept)} samples were left out because time runs backwards there")
        stamps, values = stamps[kept], values[kept]
    if np.any(np.diff(stamps) > _LONGEST_GAP):
        pieces = np.split(np.arange(len(stamps)), np.flatnonzero(np.diff(stamps) > _LONGEST_GAP) + 1)
        kept = max(pieces, key=len)
        remarks.append(f"{len(stamps) - len(kept)} samples more than an hour away from the rest were left out")
        stamps, values = stamps[kept], values[kept]
    return Samples(stamps, values), tuple(remarks)


def _longest_increasing(stamps: NDArray[np.int64]) -> NDArray[np.int64]:
    """Indices of a longest strictly increasing subsequence (patience sorting)."""
    smallest_last: list[int] = []
    ends: list[int] = []
    before = np.full(len(stamps), -1)
    for index, stamp in enumerate(stamps.tolist()):
        length = bisect_left(smallest_last, stamp)
        if length == len(ends):
            smallest_last.append(stamp)
            ends.append(index)
        else:
            smallest_last[length] = stamp
            ends[length] = index
        before[index] = ends[length - 1] if length else -1
    kept = [ends[-1]]
    while before[kept[-1]] >= 0:
        kept.append(int(before[kept[-1]]))
    return np.array(kept[::-1])
