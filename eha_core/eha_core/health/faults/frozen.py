"""A channel that is exactly constant while the others go on: a driver that repeats its last sample.

A noisy channel repeats a value with a known largest probability, so that a run of equal values is too long from a known
length (FALSE_ALARMS); the samples before and after it must have the noise. In a channel without noise, or quantised
more coarsely than its noise, equal values are a piston at rest; there a position is frozen only if it jumps at the end
of the run, by more than in any sample soon after it. A command may rest and jump, unless it never rests elsewhere; if
it never jumps elsewhere, it is in doubt.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import usual_size
from eha_core.health.signal import Signal

BESIDE = 25
"""Samples before and after a run that must have the channel's noise."""
ALIVE = 0.4
"""Share of the usual noise that they must have."""
LONG = 10
"""Length of a run of equal samples in a channel whose noise is not visible."""
OF_STEPS = 0.05
"""Share of zero changes up to which a command counts as always moving."""
ALONE = 6.0
"""Smallest ratio of a leap to what comes near it, in the samples soon after it or, in doubt, in the whole channel."""


def find(signal: Signal) -> Found | None:
    """The runs of equal samples that are too long."""
    return None if _rests(signal) else _find(signal)


def find_in_doubt(signal: Signal) -> Found | None:
    """The runs of equal samples that are too long, and that rest of a command which ends by its only leap."""
    return _find(signal)


def _rests(signal: Signal) -> bool:
    """Whether it is a command that often rests, apart from the longest run of equal samples."""
    resting = np.mean(signal.steps == 0.0) - np.max(signal.runs[1]) / len(signal.steps)
    return bool(signal.is_command and resting > OF_STEPS)


def _find(signal: Signal) -> Found | None:
    starts, lengths = signal.runs
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
    """Whether the samples before and after the run, where there are any, have the channel's noise."""
    sides = (signal.values[max(0, first - BESIDE) : first], signal.values[end : end + BESIDE])
    sizes = [usual_size(np.diff(side, n=2)) / np.sqrt(6.0) for side in sides if len(side) > BESIDE // 2]
    return bool(sizes) and min(sizes) > ALIVE * signal.noise


def _leaps(signal: Signal, end: int) -> bool:
    """Whether it jumps at the end of the run: a position by more than in any sample soon after it, a command by more
    than in most, as it may step again at once."""
    if not (signal.is_command or signal.channel.unit == "m") or end + LONG > len(signal.values):
        return False
    leap, after = abs(signal.steps[end - 1]), np.abs(signal.steps[end : end + LONG])
    if _rests(signal):
        return bool(leap > ALONE * np.max(np.abs(np.delete(signal.steps, end - 1))))
    soon = float(np.median(after) if signal.is_command else np.max(after))
    return bool(leap > max(ALONE * soon, 5.0 * signal.step, 8.0 * signal.noise, signal.jump))
