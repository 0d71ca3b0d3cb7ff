"""A channel whose scale leaps: an amplifier that switches its range, a unit that changes, and the noise with it.

The noise of a sensor is of one size as long as the sensor is the same. Where the blocks before a moment have less of
it, or more, than those after it, and it is white on both sides, the scale is another one. Motion makes a channel rough,
too, but smoothly so. Oil that rings is taken for noise where the sensor is coarse; but a scale that leaps takes the
sensor's levels along, and where these stay as far apart it is the same.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Integers, quantisation
from eha_core.health.signal import SAME_SIZE, Signal, by_differences
from eha_core.recording.recording import FloatArray

APART = 2.0
"""Times the noise of one side that the other's must be."""
SMALLEST = 1e-6
"""Of the largest block's noise that any block has at least: more than a unit makes of it, and not nothing."""
CLEAR = 1.2
"""Times the larger quarter of one side's blocks that the smaller quarter of the other's must be."""
FEWEST = 4
"""Blocks on either side. A block's noise is known to an eighth, so that by chance the medians of four and of all others
differ by a sixth; by as much as APART in fewer than one recording in a million."""


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
        f"its scale is another one there: its noise is {times:.2g} times as large or as small",
        "see what changed the sensor's range or unit",
    )  # fmt: skip
    return Found([fault], signal.lost(here))


def _split(sizes: FloatArray) -> tuple[int, float]:
    """Before which block the noise becomes another, and how many times as large or as small; 0 where it does not.

    The split is where the logarithms' means before and after explain most of their scatter.
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
    """The sample at which the scale leaps: that of the largest change near the blocks' edge."""
    first, last = edges[max(0, split - 1)], edges[min(len(edges) - 1, split + 1)]
    return int(first + np.argmax(np.abs(signal.steps[first : last - 1]))) + 1
