"""The messages of one channel in the order of their stamps."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from eha_core.realtime import NANOSECONDS

Array = NDArray[np.float64]


def nanoseconds(seconds: float) -> int:
    """A time [s] in whole nanoseconds."""
    return round(seconds * NANOSECONDS)


@dataclass
class Samples:
    """One channel, ordered by stamp; a stamp that steps back begins it anew."""

    stamps: list[int] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    published: list[int] = field(default_factory=list)

    def add(self, stamp: int, value: float, published: int = 0) -> bool:
        """Append a sample; return whether time went back. A stamp that is there already is passed over."""
        went_back = bool(self.stamps) and stamp < self.stamps[-1]
        if went_back:
            self.forget(len(self.stamps))
        if not self.stamps or stamp > self.stamps[-1]:
            self.stamps.append(stamp)
            self.values.append(value)
            self.published.append(published)
        return went_back

    def forget(self, count: int) -> None:
        """Forget the `count` oldest samples."""
        del self.stamps[:count], self.values[:count], self.published[:count]

    @property
    def newest(self) -> float:
        """The last stamp [ns]; -inf before the first."""
        return self.stamps[-1] if self.stamps else -inf

    def near(self, stamp: int, reach: int) -> tuple[Array, Array]:
        """Times relative to `stamp` [s] and values within `reach` of it [ns]."""
        part = slice(bisect_left(self.stamps, stamp - reach), bisect_left(self.stamps, stamp + reach + 1))
        return (np.array(self.stamps[part]) - stamp) / NANOSECONDS, np.array(self.values[part])

    def between(self, start: int, end: int) -> tuple[NDArray[np.int64], Array]:
        """Stamps [ns] and values from `start` on, before `end`."""
        part = slice(bisect_left(self.stamps, start), bisect_left(self.stamps, end))
        return np.array(self.stamps[part], dtype=np.int64), np.array(self.values[part], dtype=np.float64)
