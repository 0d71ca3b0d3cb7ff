"""A channel whose scale leaps: an amplifier that switches its range, a unit that changes, and the noise with it.

The noise of a sensor is of one size as long as the sensor is the same. Where that of every block before a moment is
less than half, or more than twice, that of every block after it, the scale is another one. Motion can only make single
blocks noisier.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.faults.blocks import noise_by_block
from eha_core.health.signal import Signal

APART = 1.5
"""Times the noise of one side that the other's must be, its smallest fifth and the first side's largest taken."""
FEWEST = 4
"""Blocks on either side: of noise that only scatters they lie apart by chance once in 1e6 recordings, as a block's noise
is known to a tenth."""


def find(signal: Signal) -> Found | None:
    """The shorter side."""
    if signal.is_command or not signal.is_noisy:
        return None
    edges, sizes = noise_by_block(signal)
    best = (APART, 0)
    for split in range(FEWEST, len(sizes) - FEWEST + 1):
        before, after = sizes[:split], sizes[split:]
        low, high = (before, after) if np.median(before) < np.median(after) else (after, before)
        ratio = float(np.quantile(high, 0.1) / max(np.quantile(low, 0.9), 1e-300))
        if ratio > best[0] * 1.02:
            best = (ratio, split)
    if not best[1]:
        return None
    moment = _moment(signal, edges, best[1])
    here = np.zeros(len(signal.values), dtype=np.bool_)
    shorter = slice(0, moment) if moment < len(here) / 2 else slice(moment, len(here))
    here[shorter] = True
    inside = signal.time[shorter]
    fault = Fault(
        signal.name, "jump", float(inside[0]), float(inside[-1]),
        f"its scale is another one there: its noise is {best[0]:.2g} times as large or as small",
        "see what changed the sensor's range or unit",
    )  # fmt: skip
    return Found([fault], signal.lost(here))


def _moment(signal: Signal, edges: np.ndarray, split: int) -> int:
    """The sample at which the scale leaps: that of the largest change near the blocks' edge."""
    first, last = edges[max(0, split - 1)], edges[min(len(edges) - 1, split + 1)]
    return int(first + np.argmax(np.abs(signal.steps[first : last - 1]))) + 1
