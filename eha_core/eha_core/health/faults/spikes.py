"""Lone samples that their neighbours contradict: a bit that flips, a spark on a cable.

By `find_outliers` with a limit that no normal noise passes. Where friction lets go, a sound pressure may have such a
sample of ten times the noise; those are excluded from fits all the same, and not called a fault.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import find_outliers
from eha_core.health.signal import Signal

FAR = 25.0
"""Times the noise (bags/rig_coulomb_friction.mcap has samples at 11, and nothing is wrong with its sensors)."""
STEPS = 5.0
"""Quantisation steps of a channel that is at rest between two levels."""
BESIDE = 8.0
"""Times what is usual nearby."""
OF_EXTENT = 0.15
"""Of the channel's extent that a spike is at least: a pressure that is sampled slowly may have less in one sample."""
AFTERWARDS = 5
"""Samples to either side of a spike that go on as if it were not there: after a blow in a chamber its oil rings."""
RINGS = 0.15
"""Share of a spike by which they may differ from the mean of those beside them."""
USUAL, LEVELS = 5.0, 2.0
"""Times the noise, and levels, that they may differ by in any case."""


def find(signal: Signal) -> Found | None:
    """The lone samples, as one fault from the first to the last."""
    if signal.is_command:
        return None
    least = max(FAR * signal.noise, STEPS * signal.level, OF_EXTENT * signal.extent)
    here = find_outliers(signal.values, least / BESIDE, BESIDE)
    here &= [not there or _is_undisturbed(signal, place) for place, there in enumerate(here)]
    if not here.any():
        return None
    when, count = signal.time[here], int(here.sum())
    seen = "1 sample that its neighbours contradict" if count == 1 else f"{count} lone samples off their neighbours"
    fault = Fault(signal.name, "spikes", float(when[0]), float(when[-1]), seen, "see what disturbs the cable", False)
    return Found([fault], signal.lost(here))


def _is_undisturbed(signal: Signal, place: int) -> bool:
    """Whether the samples beside a spike go on as if it were not there."""
    first = max(0, place - AFTERWARDS)
    beside = np.delete(signal.values[first : place + AFTERWARDS + 1], place - first)
    size = abs(signal.values[place] - 0.5 * (signal.values[place - 1] + signal.values[place + 1]))
    rough = np.abs(beside[1:-1] - 0.5 * (beside[:-2] + beside[2:]))
    return bool(np.max(rough) < max(RINGS * size, USUAL * signal.noise, LEVELS * signal.level))
