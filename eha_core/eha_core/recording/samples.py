"""Orders the samples of one channel: increasing stamps and finite values; the rest is excluded and counted."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.recording.channel_kinds import FloatArray

LONGEST_GAP = 3_600_000_000_000
"""ns without a sample, after which the rest is of another run or has wrong stamps."""


@dataclass(frozen=True)
class Samples:
    """Stamps [ns] and values of one channel, as recorded or in order."""

    stamps: NDArray[np.int64]
    values: FloatArray


def put_in_order(samples: Samples) -> tuple[Samples, tuple[str, ...]]:
    """The finite samples of the longest run of increasing stamps, and remarks on what was excluded.

    After a clock jumps back, the shorter side is excluded; of a stamp far ahead only that sample.
    """
    remarks = []
    stamps, values = samples.stamps, samples.values
    finite = np.isfinite(values)
    if not finite.all():
        remarks.append(f"{np.count_nonzero(~finite)} samples that are not finite numbers were left out")
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
    if np.any(np.diff(stamps) > LONGEST_GAP):
        pieces = np.split(np.arange(len(stamps)), np.flatnonzero(np.diff(stamps) > LONGEST_GAP) + 1)
        kept = max(pieces, key=len)
        remarks.append(f"{len(stamps) - len(kept)} samples more than an hour away from the rest were left out")
        stamps, values = stamps[kept], values[kept]
    return Samples(stamps, values), tuple(remarks)


def on_one_span(
    ordered: Mapping[str, Samples], recorded: Mapping[str, Samples], held: Collection[str]
) -> tuple[dict[str, Samples], tuple[str, ...]]:
    """All channels on the time span of the longest one, and remarks on what was excluded.

    Args:
        ordered: the channels, each in order.
        recorded: the same as recorded.
        held: channels whose last value holds, so that they may end before others begin.
    """
    measured = {name: series for name, series in ordered.items() if name not in held} or dict(ordered)
    longest = max(measured, key=lambda name: len(measured[name].stamps))
    start, end = (int(measured[longest].stamps[edge]) for edge in (0, -1))
    kept, remarks = {}, []
    for name, series in ordered.items():
        first, last = int(series.stamps[0]), int(series.stamps[-1])
        if first <= end and (last >= start or (name in held and start - last <= LONGEST_GAP)):
            kept[name] = series
            continue
        stamps = recorded[name].stamps
        inside = (stamps >= start) & (stamps <= end)
        again, _ = put_in_order(Samples(stamps[inside], recorded[name].values[inside]))
        if not len(again.values):
            remarks.append(f"{name} was recorded at another time than {longest} and was left out")
            continue
        kept[name] = again
        remarks.append(f"{name}: {np.count_nonzero(~inside)} samples of another time than {longest}'s were left out")
    return kept, tuple(remarks)


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
