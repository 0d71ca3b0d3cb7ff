"""A stretch of what a twin heard of its rig, on one clock: what is kept, named and recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.twin.samples import Array

Stamps = NDArray[np.int64]
Series = tuple[Stamps, Array]


@dataclass(frozen=True)
class Excerpt:
    """The voltage in force and the measured channels over an interval without gaps.

    Attributes:
        start, end: the interval's stamps [ns].
        voltage: the drive's voltage [V] and the stamp from which each acts, the first at `start`.
        channels: stamps and values of each channel [m], [Pa above the return line's reference].
    """

    start: int
    end: int
    voltage: Series
    channels: Mapping[str, Series]

    def part(self, start: int, end: int) -> Excerpt:
        """What of it lies between two stamps [ns]."""
        start, end = max(start, self.start), min(end, self.end)
        stamps, values = self.voltage
        acting = slice(int(np.searchsorted(stamps, start, side="right")) - 1, int(np.searchsorted(stamps, end)))
        voltage = np.maximum(stamps[acting], start), values[acting]
        return Excerpt(start, end, voltage, {name: _within(one, start, end) for name, one in self.channels.items()})


def joined(excerpts: Sequence[Excerpt]) -> Excerpt:
    """Excerpts that follow each other, as one."""
    names = dict.fromkeys(name for excerpt in excerpts for name in excerpt.channels)
    channels = {
        name: _one_after_another([excerpt.channels[name] for excerpt in excerpts if name in excerpt.channels])
        for name in names
    }
    voltage = held_changes(*_one_after_another([excerpt.voltage for excerpt in excerpts]))
    return Excerpt(excerpts[0].start, excerpts[-1].end, voltage, channels)


def held_changes(stamps: Stamps, values: Array) -> Series:
    """A held signal without the samples that repeat the value before."""
    changed = np.append(True, np.diff(values) != 0.0)
    return stamps[changed], values[changed]


def _within(series: Series, start: int, end: int) -> Series:
    stamps, values = series
    part = slice(int(np.searchsorted(stamps, start)), int(np.searchsorted(stamps, end)))
    return stamps[part], values[part]


def _one_after_another(parts: Sequence[Series]) -> Series:
    return np.concatenate([stamps for stamps, _ in parts]), np.concatenate([values for _, values in parts])
