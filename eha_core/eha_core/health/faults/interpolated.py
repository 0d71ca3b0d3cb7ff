"""A channel that an exporter interpolated from a slower rate: straight lines from one sample to the next.

Its second differences are zero except at regular times. A sensor's interpolated samples are excluded, which corrects
it. A command between two of its own samples is not known: the drive received steps, or values that were not recorded.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.faults.regular import regular
from eha_core.health.signal import Signal

STRAIGHT = 0.02
"""Share of a large second difference (the 99th percentile) up to which one counts as zero, given a file's rounding."""
SLOWEST = 0.1
"""s; longest time between two corners; longer straight lines may be a reference of ramps (assumed)."""
LOST = 0.01
"""s; time between two corners of a command from which a valve responds to the lost samples between them (assumed)."""
ALIKE = 0.05
"""Spread of the corners, over their mean, below which they are a triangle's."""


def find(signal: Signal) -> Found | None:
    """The stretches of straight lines."""
    bend = np.abs(np.diff(np.diff(signal.values) / np.diff(signal.time)))
    corners = np.flatnonzero(bend > STRAIGHT * float(np.quantile(bend, 0.99))) + 1
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for first, last, interval in regular(corners):
        sizes = bend[corners[first:last] - 1]
        if interval * signal.period > SLOWEST or np.std(sizes) < ALIKE * np.mean(sizes):
            continue
        begin, end = corners[first], corners[last]
        end = end if last + 1 < len(corners) else len(here)  # beyond the last corner, too, there is a line
        here[begin:end] = True
        here[corners[first : last + 1]] = False
        if interval == round(interval):
            here[begin : end : round(interval)] = False  # a sample, too, where the corner is too flat to be seen
        rate = 1.0 / (interval * signal.period)
        faults.append(
            Fault(
                signal.name, "interpolated", float(signal.time[begin]), float(signal.time[corners[last]]),
                f"interpolated from {rate:.3g} Hz", "export it as it was recorded, without resampling", False,
                signal.is_command and interval * signal.period > LOST,
            )
        )  # fmt: skip
    if not faults:
        return None
    return Found(faults, signal.lost(here) if not signal.is_command else signal.lost(np.zeros_like(here)))
