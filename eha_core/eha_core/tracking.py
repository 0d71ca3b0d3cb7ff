"""How well a measured motion follows its reference: pairs by stamp, not by arrival, and exact error sums."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import deque
from dataclasses import dataclass
from math import isfinite, sqrt

_NANOSECONDS = 1_000_000_000
_PATIENCE = 5 * _NANOSECONDS
_LARGEST = 1e100
_UNIT = 2**1074
"""Every float is a whole multiple of 1 / _UNIT, so sums of such integers are exact, whatever is added or taken away."""


@dataclass(frozen=True)
class TrackingSample:
    """One pair and the statistics after it.

    Attributes:
        stamp: the instant both values of the pair belong to [ns].
        error: measured minus reference [m].
        rmse_window: root mean square error over the sliding window that ends at the newest pair [m].
        rmse: root mean square error since the last reset [m].
        largest_error: largest absolute error since the last reset [m].
        count: pairs since the last reset.
    """

    stamp: int
    error: float
    rmse_window: float
    rmse: float
    largest_error: float
    count: int


class _Samples:
    """Stamps and values of one stream, ordered by stamp."""

    def __init__(self) -> None:
        self.stamps: list[int] = []
        self.values: list[float] = []

    def add(self, stamp: int, value: float) -> None:
        """Insert a sample; one of the same stamp is replaced."""
        if not self.stamps or stamp > self.stamps[-1]:
            self.stamps.append(stamp)
            self.values.append(value)
            return
        place = bisect_left(self.stamps, stamp)
        if self.stamps[place] == stamp:
            self.values[place] = value
        else:
            self.stamps.insert(place, stamp)
            self.values.insert(place, value)

    def forget(self, count: int) -> None:
        """Forget the `count` oldest samples."""
        del self.stamps[:count], self.values[:count]


class Tracker:
    """Pairs two streams of samples and keeps the error's statistics.

    A measured sample is paired with the reference of the same stamp, or else with the line between the references
    before and after it. Either stream may run ahead of the other by up to 5 s.

    Args:
        window: length of the sliding window [s].
        disorder: how late a sample may come within its own stream [s]: interpolation waits that long for a reference
            in between, and a stamp that lies further back is taken for a clock set back.
        longest_gap: references further apart are not interpolated, and what was measured between them not counted [s].
    """

    def __init__(self, window: float = 1.0, disorder: float = 0.02, longest_gap: float = 1.0) -> None:
        self._window = round(window * _NANOSECONDS)
        self._disorder = round(disorder * _NANOSECONDS)
        self._longest_gap = round(longest_gap * _NANOSECONDS)
        self._references = _Samples()
        self._waiting = _Samples()
        self._newest: dict[str, int] = {}
        self._set_back_first: str | None = None
        self.reset()

    def reset(self) -> None:
        """Begin the statistics anew; samples that wait for their partner stay."""
        self.unpaired = 0
        self._count = 0
        self._largest = 0.0
        self._sum = 0
        self._recent: deque[tuple[int, int]] = deque()
        self._recent_sum = 0

    def measured(self, stamp: int, value: float) -> tuple[TrackingSample, ...]:
        """Take a measured sample (stamp [ns], value [m]); return the pairs that are complete now, ordered by stamp."""
        if not _usable(value):
            self.unpaired += 1
            return ()
        if self._is_set_back("measured", stamp):
            self._recent.clear()
            self._recent_sum = 0
        self._waiting.add(stamp, value)
        return self._pair()

    def reference(self, stamp: int, value: float) -> tuple[TrackingSample, ...]:
        """Take a reference sample, as `measured` does."""
        if not _usable(value):
            return ()
        self._is_set_back("reference", stamp)
        self._references.add(stamp, value)
        stamps = self._references.stamps
        if stamps[-1] - stamps[0] > 2 * _PATIENCE:
            self._references.forget(bisect_left(stamps, stamps[-1] - _PATIENCE))
        return self._pair()

    def _is_set_back(self, stream: str, stamp: int) -> bool:
        """Whether the clock was set back, so that samples of before must not meet those of now; then forget them."""
        is_set_back = stamp < self._newest.get(stream, stamp) - self._disorder
        self._newest[stream] = stamp if is_set_back else max(stamp, self._newest.get(stream, stamp))
        if not is_set_back:
            return False
        own, other = self._waiting, self._references
        if stream == "reference":
            own, other = other, own
        own.forget(len(own.stamps))
        if self._set_back_first in (None, stream):
            # The other stream is still in the former time; what it brings until it is set back too goes then.
            other.forget(len(other.stamps))
            self._set_back_first = stream
        else:
            self._set_back_first = None
        return True

    def _pair(self) -> tuple[TrackingSample, ...]:
        pairs = []
        done = 0
        for stamp, value in zip(self._waiting.stamps, self._waiting.values, strict=True):
            settled, reference = self._reference_at(stamp)
            if not settled and self._waiting.stamps[-1] - stamp <= _PATIENCE:
                break
            done += 1
            if reference is None:
                self.unpaired += 1
            else:
                pairs.append(self._count_in(stamp, value - reference))
        self._waiting.forget(done)
        return tuple(pairs)

    def _reference_at(self, stamp: int) -> tuple[bool, float | None]:
        """Whether the reference at `stamp` is settled, and its value; None where there is none to interpolate."""
        stamps, values = self._references.stamps, self._references.values
        after = bisect_left(stamps, stamp)
        if after < len(stamps) and stamps[after] == stamp:
            return True, values[after]
        if after == len(stamps) or stamps[-1] < stamp + self._disorder:
            return False, None
        if after == 0 or stamps[after] - stamps[after - 1] > self._longest_gap:
            return True, None
        share = (stamp - stamps[after - 1]) / (stamps[after] - stamps[after - 1])
        return True, values[after - 1] + share * (values[after] - values[after - 1])

    def _count_in(self, stamp: int, error: float) -> TrackingSample:
        numerator, denominator = (error * error).as_integer_ratio()
        square = numerator * (_UNIT // denominator)
        self._count += 1
        self._sum += square
        self._largest = max(self._largest, abs(error))
        if self._recent and stamp < self._recent[-1][0]:
            insort(self._recent, (stamp, square))
        else:
            self._recent.append((stamp, square))
        self._recent_sum += square
        while self._recent[0][0] <= self._recent[-1][0] - self._window:
            self._recent_sum -= self._recent.popleft()[1]
        return TrackingSample(
            stamp,
            error,
            _root_mean(self._recent_sum, len(self._recent)),
            _root_mean(self._sum, self._count),
            self._largest,
            self._count,
        )


def _root_mean(total: int, count: int) -> float:
    return sqrt(total / (count * _UNIT))


def _usable(value: float) -> bool:
    return isfinite(value) and abs(value) < _LARGEST
