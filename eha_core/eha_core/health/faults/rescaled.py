"""A channel whose scale jumps, and its noise with it: an amplifier that switches its range, a unit that changes.

A sensor's noise stays the same as long as the sensor does. If the blocks before a time have less or more noise than
those after it, and it is white on both sides, the scale has changed. The roughness of motion is not white. With a
coarse sensor, ringing oil looks like noise; but a change of scale also changes the distance between the sensor's
levels, and where that stays the same, so does the scale.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Integers, quantisation
from eha_core.health.signal import SAME_SIZE, Signal, by_differences
from eha_core.recording.recording import FloatArray

APART = 2.0
"""Smallest ratio of the noise on both sides."""
SMALLEST = 1e-6
"""Noise that every block is given at least, as a share of the largest block's: below any change of unit, but not 0."""
CLEAR = 1.2
"""Smallest ratio of the lower quartile of the noisier side's blocks to the upper quartile of the other's."""
FEWEST = 4
"""Fewest blocks on either side. A block's noise is known to an eighth, so that by chance the medians of four and of all
others differ by a sixth; by APART in fewer than one recording in a million."""


def find(signal: Signal) -> Found | None:
    """The shorter side."""
    if signal.is_command or not signal.is_noisy:
        return None
    edges, sizes = signal.blocks
    split, times = _split(sizes)
    if not split:
        return None
    moment = _moment(signal, edges, split)
    sides = (signal.values[:moment], signal.values[moment:])
    if not all(_is_white(side) for side in sides) or _have_the_same_levels(*sides):
        return None
    here = np.zeros(len(signal.values), dtype=np.bool_)
    shorter = slice(0, moment) if moment < len(here) / 2 else slice(moment, len(here))
    here[shorter] = True
    inside = signal.time[shorter]
    fault = Fault(
        signal.name, "jump", float(inside[0]), float(inside[-1]),
        f"its scale changes: its noise is {times:.2g} times as large or as small",
        "see what changed the sensor's range or unit",
    )  # fmt: skip
    return Found([fault], signal.lost(here))


def _split(sizes: FloatArray) -> tuple[int, float]:
    """The block before which the noise changes, and the factor by which it rises or falls; 0 where it does not.

    The split is where the means of the logarithms before and after explain most of their variance.
    """
    logarithms = np.log(np.maximum(sizes, SMALLEST * float(np.max(sizes))))
    count = np.arange(1, len(sizes))
    before = np.cumsum(logarithms)[:-1] / count
    after = np.cumsum(logarithms[::-1])[:-1][::-1] / (len(sizes) - count)
    explained = count * (len(sizes) - count) * (before - after) ** 2
    split = FEWEST + int(np.argmax(explained[FEWEST - 1 : 1 - FEWEST])) if len(sizes) >= 2 * FEWEST else 0
    if not split:
        return 0, 1.0
    sides = (sizes[:split], sizes[split:])
    low, high = sides if np.median(sides[0]) < np.median(sides[1]) else sides[::-1]
    times = float(np.median(high)) / max(float(np.median(low)), 1e-300)
    is_clear = float(np.quantile(high, 0.25)) > CLEAR * float(np.quantile(low, 0.75))
    return (split, times) if times > APART and is_clear else (0, times)


def _is_white(values: FloatArray) -> bool:
    third, fifth = (by_differences(values, order) for order in (3, 5))
    return SAME_SIZE[0] < third / max(fifth, 1e-300) < SAME_SIZE[1]


def _have_the_same_levels(before: FloatArray, after: FloatArray) -> bool:
    finer, coarser = sorted((quantisation(before), quantisation(after)))
    return 0.0 < coarser < APART * finer


def _moment(signal: Signal, edges: Integers, split: int) -> int:
    """The sample at which the scale jumps: that of the largest change near the blocks' edge."""
    first, last = edges[max(0, split - 1)], edges[min(len(edges) - 1, split + 1)]
    return int(first + np.argmax(np.abs(signal.steps[first : last - 1]))) + 1
