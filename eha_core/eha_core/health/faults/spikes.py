"""Outliers of one sample or two: a flipped bit, a spark on a cable.

They are found by `find_outliers` with a limit that no normal noise exceeds. Where friction breaks away, a sound
pressure may have a sample ten times the noise off; it is excluded from fits as well, but is not called a fault.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Flags, find_outliers
from eha_core.health.signal import Signal

FAR = 25.0
"""Times the noise (bags/rig_coulomb_friction.mcap has samples at 11, and nothing is wrong with its sensors)."""
STEPS = 5.0
"""Smallest spike in quantisation steps, for a channel at rest between two levels."""
BESIDE = 8.0
"""Smallest spike, as a multiple of the usual roughness nearby."""
OF_EXTENT = 0.15
"""Smallest spike, as a share of the channel's range: a slowly sampled pressure may change by less in one sample."""
AFTERWARDS = 5
"""Samples on either side of a spike that it must not affect: after a real shock the oil in a chamber rings."""
RINGS = 0.15
"""Share of a spike by which these may differ from the mean of their neighbours."""
USUAL, LEVELS = 5.0, 2.0
"""Multiple of the noise, and number of levels, by which they may differ in any case."""


def find(signal: Signal) -> Found | None:
    """The spikes, as one fault from the first to the last."""
    if signal.is_command:
        return None
    least = max(FAR * signal.noise, STEPS * signal.level, OF_EXTENT * signal.extent)
    here = find_outliers(signal.values, least / BESIDE, BESIDE)
    while not all(lone := [_is_undisturbed(signal, here, place) for place in np.flatnonzero(here)]):
        here[here] = lone
    if not here.any():
        return None
    when, count = signal.time[here], int(here.sum())
    seen = "1 sample far off its neighbours" if count == 1 else f"{count} samples far off their neighbours"
    fault = Fault(signal.name, "spikes", float(when[0]), float(when[-1]), seen, "see what disturbs the cable", False)
    return Found([fault], signal.lost(here))


def _is_undisturbed(signal: Signal, spikes: Flags, place: int) -> bool:
    """Whether a spike does not affect the samples on either side of it that are no spikes themselves."""
    about = slice(max(0, place - AFTERWARDS), place + AFTERWARDS + 1)
    rest = ~spikes[about]
    beside, offset = signal.values[about][rest], place - about.start
    size = abs(signal.values[place] - np.interp(offset, np.flatnonzero(rest), beside))
    rough = np.abs(beside[1:-1] - 0.5 * (beside[:-2] + beside[2:]))
    return bool(np.max(rough) < max(RINGS * size, USUAL * signal.noise, LEVELS * signal.level))
