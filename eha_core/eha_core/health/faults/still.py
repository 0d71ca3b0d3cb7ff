"""A piston that does not move: its position is a constant and noise.

The means of blocks scatter as white noise of the samples says, within a factor of two in power: over 20 blocks and more
that is one sound recording in a thousand whose piston moves by as little as its noise, and none whose motion shows.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.signal import Signal

SECONDS, FEWEST = 0.1, 20
"""A block's length and how many there are at least."""
MOTION = 2.0
"""Power of the means over that of noise from which on there is motion."""


def find(signal: Signal) -> Found | None:
    """The whole recording."""
    if signal.name != "position" or not signal.is_noisy:
        return None
    count = int((signal.time[-1] - signal.time[0]) / SECONDS)
    if count < FEWEST:
        return None
    length = len(signal.values) // count
    means = signal.values[: count * length].reshape(count, length).mean(axis=1)
    if np.var(means) * length > MOTION * signal.noise**2:
        return None
    spans = 1e6 * float(np.ptp(signal.values))
    fault = Fault(
        signal.name, "still", float(signal.time[0]), float(signal.time[-1]),
        f"does not move: it spans {spans:.3g} um, all of it noise", "record a test that moves the piston", False, True,
    )  # fmt: skip
    return Found([fault], np.zeros(len(signal.channel.values), dtype=np.bool_))
