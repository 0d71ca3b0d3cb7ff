"""A channel that is disturbed over an interval: a motor that starts near the cable, a loose connector.

Its noise there is many times as large as in most of the recording, and white; the roughness of motion is not white.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.signal import SAME_SIZE, Signal, by_differences, covered

TIMES = 6.0
"""Times the usual noise."""
MOST = 0.5
"""Largest share of the recording that may be disturbed; above it, the usual noise is not known."""


def find(signal: Signal) -> Found | None:
    """The spans in which the channel is disturbed."""
    if signal.is_command or not signal.is_noisy:
        return None
    edges, sizes = signal.blocks
    loud = sizes > TIMES * float(np.median(sizes))
    if not loud.any() or np.mean(loud) > MOST:
        return None
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for first, last in covered(loud):
        begin, end = edges[first], edges[last + 1]
        inside = signal.values[begin:end]
        third, fifth = (by_differences(inside, order) for order in (3, 5))
        if not SAME_SIZE[0] < third / fifth < SAME_SIZE[1]:
            continue
        # the interval may begin and end within a neighbouring block
        begin, end = edges[max(0, first - 1)], edges[min(len(edges) - 1, last + 2)]
        rough = np.abs(np.diff(signal.values[begin:end], n=2)) > TIMES * np.sqrt(6.0) * float(np.median(sizes))
        places = np.flatnonzero(rough)
        begin, end = begin + places[0], begin + places[-1] + 2
        here[begin : end + 1] = True
        times = float(np.max(sizes[first : last + 1]) / np.median(sizes))
        faults.append(
            Fault(
                signal.name, "noisy", float(signal.time[begin]), float(signal.time[min(end, len(here) - 1)]),
                f"disturbed: its noise is {times:.2g} times the usual",
                "see what disturbs the cable",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here)) if faults else None
