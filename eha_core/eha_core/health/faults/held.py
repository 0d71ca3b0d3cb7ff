"""A sensor's channel that was sampled at a slower rate, with each value held until the next.

Its values change at regular times only, and by different amounts. (A quantised encoder at a steady speed also changes
at regular times, but by one step each time.) The repeated samples are excluded, which leaves the channel at its own
rate.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.faults.regular import regular
from eha_core.health.signal import Signal

SEVERAL = 0.5
"""Share of the changes that must be more than one and a half times the smallest."""


def find(signal: Signal) -> Found | None:
    """The stretches in which the channel is held."""
    if signal.is_command:
        return None
    starts, _ = signal.runs
    changes = np.abs(np.diff(signal.values[starts]))
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for first, last, interval in regular(starts):
        amounts = changes[first:last]
        if np.mean(amounts > 1.5 * np.min(amounts)) < SEVERAL:
            continue
        begin, end = starts[first], starts[last]
        here[begin:end] = True
        here[starts[first:last]] = False
        rate = 1.0 / (interval * signal.period)
        faults.append(
            Fault(
                signal.name, "held", float(signal.time[begin]), float(signal.time[end]),
                f"sampled at {rate:.3g} Hz and repeated in between", "record the sensor at its own rate", False,
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here)) if faults else None
