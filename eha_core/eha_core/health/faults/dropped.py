"""A channel that drops to a fill value: an interface without a sample gives zero, or the end of its range.

It is found where the value jumps away and back and is exactly constant in between, or jumps away and stays constant to
the end. A sound channel does neither: the position cannot jump, and a pressure that jumps is not constant afterwards.
In a command of steps, which may jump, a fill value lies outside all others by more than their range, occurs more than
once, and returns at once to the value before.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Integers
from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

CONSTANT = 3
"""Equal samples after a jump that make their value a fill value; a value that occurs twice needs only one sample."""
AT_THE_END = 10
"""Equal samples from a jump to the recording's end."""
FAR = 0.25
"""Smallest jump to a fill value, as a share of the channel's range; a pressure rings by less within a sample."""
LONGEST = 0.25
"""Largest share of the channel that may be filled; above it, the rest may be wrong instead."""
OF_STEPS = 0.2
"""Share of zero changes from which a command consists of steps."""
OF_SPAN = 0.25
"""Change of a command of steps across a fill value, as a share of its range, that is allowed (assumed)."""
AT_ONCE = 0.1
"""s; longest time of a command of steps at a fill value; a test's pulse is longer (assumed)."""


def find(signal: Signal) -> Found | None:
    """The runs of a fill value."""
    steps = np.abs(signal.steps)
    if signal.is_command and np.mean(steps == 0.0) > OF_STEPS:
        return _of_steps(signal)
    starts, lengths = signal.runs
    last = len(signal.values) - 1
    ends = starts + lengths - 1
    leaps = np.concatenate([[0.0], steps, [np.inf]])  # change before each sample, and after the last
    far = max(signal.jump, FAR * signal.extent)
    begins, returns = leaps[starts] > far, leaps[ends + 1] > far
    at_the_end = (ends == last) & (lengths >= AT_THE_END)
    within = begins & returns & (ends < last)
    filled = signal.values[starts]
    short = within & (lengths < CONSTANT)
    repeated = np.isin(filled, _more_than_once(filled[within]))
    chosen = (within & (lengths >= CONSTANT)) | (short & repeated)
    if lengths[chosen].sum() > LONGEST * len(signal.values):
        return None
    chosen |= begins & at_the_end
    if not chosen.any():
        return None
    return _filled(signal, starts[chosen], ends[chosen])


def _of_steps(signal: Signal) -> Found | None:
    """The runs of a fill value in a command of steps."""
    starts, lengths = signal.runs
    ends = starts + lengths - 1
    for value in (np.min(signal.values), np.max(signal.values)):
        at = signal.values == value
        others = signal.values[~at]
        span = float(np.ptp(others)) if len(others) else 0.0
        if not 0.0 < span < float(np.min(np.abs(others - value))):
            continue
        chosen = (signal.values[starts] == value) & (starts > 0) & (ends < len(at) - 1)
        if np.sum(chosen) < 2 or np.max(lengths[chosen]) * signal.period > AT_ONCE:
            continue
        moved = np.abs(signal.values[ends[chosen] + 1] - signal.values[starts[chosen] - 1])
        if np.median(moved) < OF_SPAN * span:
            return _filled(signal, starts[chosen], ends[chosen])
    return None


def _filled(signal: Signal, starts: Integers, ends: Integers) -> Found:
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for first, final in zip(starts, ends, strict=True):
        here[first : final + 1] = True
        faults.append(
            Fault(
                signal.name, "dropped", float(signal.time[first]), float(signal.time[final]),
                f"drops to {signal.values[first]:.4g} {signal.channel.unit}, a fill value",
                "see why the interface has no sample there",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here))


def _more_than_once(values: FloatArray) -> FloatArray:
    distinct, counts = np.unique(values, return_counts=True)
    return np.asarray(distinct[counts > 1])
