"""The quantities of a channel that the checks share, computed once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import comb, erf, sqrt

import numpy as np

from eha_core.health.noise import ROUNDING, Flags, Integers, estimate_noise, quantisation, usual_sizes
from eha_core.recording import Channel
from eha_core.recording.recording import FloatArray

COMMANDS = ("voltage_command",)
"""Channels from a controller, in which steps, holds and constant values are normal."""
SAME_SIZE = (0.6, 1.7)
"""Range of the ratio of third to fifth differences that counts as noise: white noise has 1, a smooth signal without
noise 5 and more, because each difference removes more of it."""
COARSE = 0.5
"""Noise, in quantisation steps, from which two samples of a channel at rest are often on different levels."""
BLOCK, BLOCK_SAMPLES = 0.25, 60
"""Shortest block, in seconds and in samples: its noise is then known to an eighth."""
ALIKE = 0.1
"""Share of distinct values below which many values are equal."""
ORDER = 4
"""Order of the differences that show noise and not motion."""
RARE, FEW = 0.005, 16
"""Share of a channel's changes, and least number of them, that may be due to a fault."""
TOGETHER = 0.05
"""s; longest gap between two samples of a fault that counts as part of it."""
FALSE_ALARMS = 1e-6
"""Probability with which a check may find a fault in a sound channel."""


@dataclass(frozen=True)
class Signal:
    """A channel's samples that no earlier check excluded: `time` [s], `values`, and their indices in the channel
    (`places`)."""

    channel: Channel
    places: Integers

    @classmethod
    def of(cls, channel: Channel) -> Signal:
        """All samples of a channel."""
        return cls(channel, np.arange(len(channel.time)))

    def without(self, lost: Flags) -> Signal:
        """The signal without the channel's samples that are flagged as lost."""
        return Signal(self.channel, self.places[~lost[self.places]])

    def lost(self, here: Flags) -> Flags:
        """Flags over this signal's samples as flags over the channel's."""
        flags = np.zeros(len(self.channel.time), dtype=np.bool_)
        flags[self.places[here]] = True
        return flags

    @property
    def name(self) -> str:
        """The channel's name."""
        return self.channel.name

    @property
    def is_command(self) -> bool:
        """Whether it comes from a controller, not from a sensor."""
        return self.name in COMMANDS

    @cached_property
    def time(self) -> FloatArray:
        """(n,) [s]."""
        return np.asarray(self.channel.time[self.places])

    @cached_property
    def values(self) -> FloatArray:
        """(n,) in the channel's unit."""
        return np.asarray(self.channel.values[self.places])

    @cached_property
    def period(self) -> float:
        """Usual sampling period [s]."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def steps(self) -> FloatArray:
        """(n - 1,) the change from each sample to the next; zero where samples are missing between them."""
        return np.where(np.diff(self.time) < 2.5 * self.period, np.diff(self.values), 0.0)

    @cached_property
    def noise(self) -> float:
        """Standard deviation of its white noise, quantisation included."""
        return estimate_noise(self.values)

    @cached_property
    def step(self) -> float:
        """Quantisation step; 0 where its values are on no grid. For a channel with two levels, it is their distance."""
        two_levels = len(np.unique(self.values)) == 2
        return float(np.ptp(self.values)) if two_levels else quantisation(self.values)

    @cached_property
    def level(self) -> float:
        """The smallest difference between two of its values, where many are equal; else `step`."""
        distinct = np.unique(self.values)
        apart = np.diff(distinct)
        apart = apart[apart > ROUNDING * float(np.max(np.abs(self.values)))]
        return float(np.min(apart)) if 0 < len(apart) < ALIKE * len(self.values) else self.step

    @cached_property
    def is_noisy(self) -> bool:
        """Whether it has sensor noise, so that neighbouring samples differ."""
        sizes = [by_differences(self.values, order) for order in (3, 5)]
        if not sizes[1] > 1e-9 * float(np.max(np.abs(self.values))):
            return False
        white = SAME_SIZE[0] < sizes[0] / sizes[1] < SAME_SIZE[1]
        return white and self.own_noise > COARSE * self.step

    @cached_property
    def own_noise(self) -> float:
        """Standard deviation of the noise without that of quantisation."""
        return sqrt(max(self.noise**2 - self.step**2 / 12.0, 0.0))

    @cached_property
    def repeats(self) -> float:
        """Largest probability that a sample of a noisy channel equals the one before."""
        if not self.step > 0.0:
            return 1e-3
        return max(1e-3, erf(self.step / (2.0 * sqrt(2.0) * max(self.own_noise, 1e-300))))

    @cached_property
    def longest_repeat(self) -> int:
        """Length of a run of equal samples that a noisy channel has with probability FALSE_ALARMS at most; all samples
        where its noise changes none."""
        if not self.repeats < 1.0:
            return len(self.values)
        return max(4, int(np.log(FALSE_ALARMS / len(self.values)) / np.log(self.repeats)) + 2)

    @cached_property
    def jump(self) -> float:
        """Smallest change between two samples that counts as far larger than noise and the usual motion."""
        rare = max(RARE, FEW / max(len(self.steps), 1))
        usual = float(np.quantile(np.abs(self.steps), max(0.0, 1.0 - rare))) if len(self.steps) else 0.0
        return max(3.0 * usual, self.visible)

    @cached_property
    def visible(self) -> float:
        """Smallest change between two samples that counts as more than noise and a level or two."""
        return max(12.0 * self.noise, 5.0 * self.step)

    @cached_property
    def extent(self) -> float:
        """Range of its values, from the 1st to the 99th percentile."""
        low, high = np.quantile(self.values, (0.01, 0.99))
        return float(high - low)

    @cached_property
    def blocks(self) -> tuple[Integers, FloatArray]:
        """The edges of blocks, as indices of their first samples, and each block's noise."""
        length = max(BLOCK_SAMPLES, round(BLOCK / self.period))
        count = max(1, len(self.values) // length)
        edges = np.linspace(0, len(self.values), count + 1).astype(np.int64)
        rough = np.diff(self.values, n=ORDER) / sqrt(comb(2 * ORDER, ORDER))
        return edges, usual_sizes([rough[first : last - ORDER] for first, last in pairwise(edges)])

    @cached_property
    def runs(self) -> tuple[Integers, Integers]:
        """The first sample and the length of each run of one value."""
        starts = np.concatenate([[0], np.flatnonzero(np.diff(self.values) != 0.0) + 1])
        return starts, np.diff(np.concatenate([starts, [len(self.values)]]))


def by_differences(values: FloatArray, order: int) -> float:
    """Standard deviation of white noise whose differences of this order are as large as those of `values`."""
    pieces = np.array_split(np.diff(values, n=order), max(1, min(20, len(values) // 50)))
    sizes = usual_sizes([piece for piece in pieces if len(piece)])
    return float(np.quantile(sizes, 0.35)) / sqrt(comb(2 * order, order)) if len(sizes) else 0.0


def covered(flags: Flags) -> list[tuple[int, int]]:
    """The runs of set flags, as first and last index."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True)]


def joined(signal: Signal, flags: Flags) -> list[tuple[int, int]]:
    """The runs of set flags, as first and last index; runs that only noise separates are joined."""
    spans: list[tuple[int, int]] = []
    for first, last in covered(flags):
        if spans and signal.time[first] - signal.time[spans[-1][1]] < TOGETHER:
            spans[-1] = (spans[-1][0], last)
        else:
            spans.append((first, last))
    return spans
