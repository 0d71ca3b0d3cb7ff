"""A channel that stands still to the last digit while the rest goes on: a driver that repeats its last sample.

A noisy channel repeats a value with a known probability at most, so that a run of one value is too long from a known
length on (FALSE_ALARMS); its neighbours must show that the noise is there. Of a channel without noise, or one that is
quantised more coarsely than its noise, equal values are a piston at rest; there a position is frozen only where it
leaps as the run ends, further than it moves in any sample after that. A command may rest and leap, unless it is one
that never does elsewhere.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import usual_size
from eha_core.health.signal import Signal

BESIDE = 25
"""Samples beside a run that must have the noise of the channel."""
ALIVE = 0.4
"""Share of the usual noise that they must have."""
LONG = 10
"""Samples of one value in a row of a channel whose noise does not show."""
OF_STEPS = 0.05
"""Share of a command's changes that are none, up to which it is one that always moves."""


def find(signal: Signal) -> Found | None:
    """The runs of one value that are too long."""
    starts, lengths = signal.runs
    steps = signal.steps
    if signal.is_command and np.mean(steps == 0.0) - np.max(lengths) / len(steps) > OF_STEPS:
        return None
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    least = signal.longest_repeat if signal.is_noisy else LONG
    for first, length in zip(starts[lengths >= least], lengths[lengths >= least], strict=True):
        end = first + length
        if not (_is_alive_beside(signal, first, end) if signal.is_noisy else _leaps(signal, end)):
            continue
        here[first + 1 : end] = True
        faults.append(
            Fault(
                signal.name, "frozen", float(signal.time[first]), float(signal.time[end - 1]),
                f"frozen at {signal.values[first]:.4g} {signal.channel.unit}", "see why the sensor repeats its value",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here)) if faults else None


def _is_alive_beside(signal: Signal, first: int, end: int) -> bool:
    """Whether the samples beside the run have the channel's noise: to either side that there is."""
    sides = (signal.values[max(0, first - BESIDE) : first], signal.values[end : end + BESIDE])
    sizes = [usual_size(np.diff(side, n=2)) / np.sqrt(6.0) for side in sides if len(side) > BESIDE // 2]
    return bool(sizes) and min(sizes) > ALIVE * signal.noise


def _leaps(signal: Signal, end: int) -> bool:
    """Whether a position or command leaps as the run ends, further than in any sample after that."""
    if not (signal.is_command or signal.channel.unit == "m") or end + LONG > len(signal.values):
        return False
    leap, after = abs(signal.steps[end - 1]), np.abs(signal.steps[end : end + LONG])
    return bool(leap > max(6.0 * float(np.max(after)), 5.0 * signal.step, 8.0 * signal.noise, signal.jump))
