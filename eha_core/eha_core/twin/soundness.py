"""Which channels of a rig that runs are frozen, or bring nothing any more."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping

import numpy as np

from eha_core.health.signal import SAME_SIZE, by_differences
from eha_core.twin.comparison import FROZEN, STALE
from eha_core.twin.samples import Array, Samples

STILL = 20
"""Samples of one value in a row that a channel with noise does not have (assumed)."""

LIVELY = 0.95
"""Share of a window's samples that differ from the one before where a channel has noise (assumed)."""


class Soundness:
    """Watches channels from window to window: what had noise and stands still is frozen."""

    def __init__(self) -> None:
        self._lively: set[str] = set()  # channels that have noise: no sample is like the one before it
        self._ended: dict[str, int] = {}  # the last stamp of each channel when samples were forgotten [ns]

    def note_ends(self, channels: Mapping[str, Samples]) -> None:
        """Keep each channel's last stamp, before samples are forgotten."""
        self._ended |= {name: samples.stamps[-1] for name, samples in channels.items() if samples.stamps}

    def unsound(self, channels: Mapping[str, Samples], start: int, end: int) -> dict[str, tuple[str, int]]:
        """The channels that brought nothing up to the end of a window, or stood still to the last digit in it."""
        found: dict[str, tuple[str, int]] = {}
        for name, samples in channels.items():
            if samples.newest < end:
                last = samples.stamps[-1] if samples.stamps else self._ended.get(name)
                found |= {name: (STALE, last)} if last is not None else {}
                continue
            part = slice(bisect_left(samples.stamps, start), bisect_left(samples.stamps, end + 1))
            values = np.array(samples.values[part])
            frozen = self._frozen_since(name, values, samples.stamps[part])
            if frozen is not None:
                found[name] = (FROZEN, frozen)
            elif has_noise(values):
                self._lively.add(name)
        return found

    def _frozen_since(self, name: str, values: Array, stamps: list[int]) -> int | None:
        """Since when a channel, whose noise changes it with every sample, has had one value [ns]."""
        changes = np.flatnonzero(np.diff(values)) + 1
        edges = np.concatenate([[0], changes, [len(values)]]).astype(np.int64)
        longest = int(np.argmax(np.diff(edges)))
        first, count = int(edges[longest]), int(np.diff(edges)[longest])
        if name not in self._lively or count < STILL:
            return None
        return stamps[first]


def has_noise(values: Array) -> bool:
    """Whether no sample is like the one before, and what is rough in them is noise and no motion."""
    if len(values) < 2 * STILL or np.count_nonzero(np.diff(values)) < LIVELY * (len(values) - 1):
        return False
    third, fifth = (by_differences(values, order) for order in (3, 5))
    return SAME_SIZE[0] < third / max(fifth, 1e-300) < SAME_SIZE[1]
