"""A position that wraps: a counter that overflows jumps by its whole range, and goes on as before.

All its jumps have one size, far larger than any other change; noise may cause many of them where the piston passes the
counter's end slowly. The samples after a jump are not lost, but the recording does not show which turn is the true one;
the shorter parts are excluded.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.faults.jump import ALONE, AT_AN_EDGE
from eha_core.health.noise import Flags
from eha_core.health.signal import TOGETHER, Signal, joined
from eha_core.recording.recording import FloatArray

FEWEST = 2
"""Fewest jumps of one size."""
ALIKE = 0.2
"""Largest spread of their sizes over their mean: the piston moves within a sample."""
STAYS = 10
"""Samples in a row on another turn that must occur once at least; a single one is a spike."""


def find(signal: Signal) -> Found | None:
    """The parts on another turn than most samples."""
    if signal.channel.unit != "m":
        return None
    steps = _steps(signal)
    is_leap = np.abs(steps) > 0.5 * np.max(np.abs(steps), initial=0.0)
    leaps, others = np.flatnonzero(is_leap), np.abs(steps[~is_leap])
    if len(leaps) < FEWEST:
        return None
    sizes = steps[leaps]
    modulus = float(np.mean(np.abs(sizes)))
    if np.max(np.abs(np.abs(sizes) - modulus)) > ALIKE * modulus or np.ptp(signal.values) > 1.2 * modulus:
        return None
    if np.max(others, initial=0.0) > ALONE * modulus or modulus < signal.visible:
        return None
    changes = np.diff(signal.values)
    leaps = np.flatnonzero(is_leap | _apart(signal) & (np.abs(changes) > 0.5 * modulus))  # it may wrap in a hole, too
    turns = np.concatenate([[0], np.cumsum(np.sign(changes[leaps]))])
    parts = np.diff(np.concatenate([[0], leaps + 1, [len(signal.values)]]))
    most = max(set(turns.tolist()), key=lambda turn: int(parts[turns == turn].sum()))
    if np.max(parts[turns != most]) < STAYS:
        return None
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for first, last in joined(signal, np.repeat(turns != most, parts)):
        here[first : last + 1] = True
        faults.append(
            Fault(
                signal.name, "wrapped", float(signal.time[first]), float(signal.time[last]),
                f"wraps by {modulus:.4g} {signal.channel.unit}", "give the counter more bits, or unwrap the channel",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here))


def _steps(signal: Signal) -> FloatArray:
    """The change from each sample to the next, also where a few samples are missing between them."""
    steps = np.where(_apart(signal), 0.0, np.diff(signal.values))
    steps[:AT_AN_EDGE] = steps[-AT_AN_EDGE:] = 0.0
    return steps


def _apart(signal: Signal) -> Flags:
    """Whether a hole lies between a sample and the next."""
    return np.asarray(np.diff(signal.time) >= max(2.5 * signal.period, TOGETHER))
