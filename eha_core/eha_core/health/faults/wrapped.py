"""A position that wraps: a counter that overflows leaps by its whole range, and goes on as before.

All its leaps are of one size, and with them undone it has none. The samples after the leaps are not lost for good, but
which of the turns is the true one the recording does not say; the shorter parts are excluded.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.faults.jump import leaps_of
from eha_core.health.signal import Signal

FEWEST = 2
"""Leaps of one size."""
ALIKE = 0.2
"""Spread of their sizes over their mean: the piston moves on within a sample."""


def find(signal: Signal) -> Found | None:
    """The parts on another turn than most."""
    leaps = leaps_of(signal)
    if len(leaps) < FEWEST:
        return None
    sizes = signal.steps[leaps]
    modulus = float(np.mean(np.abs(sizes)))
    if np.max(np.abs(np.abs(sizes) - modulus)) > ALIKE * modulus or np.ptp(signal.values) > 1.2 * modulus:
        return None
    turns = np.concatenate([[0], np.cumsum(np.sign(sizes))])
    parts = np.diff(np.concatenate([[0], leaps + 1, [len(signal.values)]]))
    most = max(set(turns.tolist()), key=lambda turn: int(parts[turns == turn].sum()))
    here = np.repeat(turns != most, parts)
    edges = np.concatenate([[0], leaps + 1, [len(signal.values)]])
    faults = [
        Fault(
            signal.name, "wrapped", float(signal.time[edges[place]]), float(signal.time[edges[place + 1] - 1]),
            f"wraps by {modulus:.4g} {signal.channel.unit}", "give the counter more bits, or unwrap the channel",
        )
        for place in np.flatnonzero(turns != most)
    ]  # fmt: skip
    return Found(faults, signal.lost(here))
