"""A channel that saturates at the end of its range.

A noisy channel that is cut off has its extreme value many times as often as the next value; the extreme of a sound one
is reached by the tail of its noise, once or a few times.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Flags
from eha_core.health.signal import Signal, covered, joined

IN_A_ROW = 3
"""Samples of the extreme value in a row that must occur once at least."""
OFTEN = 10
"""Fewest samples of the extreme value."""
MORE = 3.0
"""Smallest ratio of their number to that of the next value that occurs."""


def find(signal: Signal) -> Found | None:
    """The intervals at the end of the range."""
    return _find(signal, in_doubt=False)


def find_in_doubt(signal: Signal) -> Found | None:
    """The intervals at the end of the range, and those of a command that rests and may have been clipped there."""
    return _find(signal, in_doubt=True)


def _find(signal: Signal, in_doubt: bool) -> Found | None:
    if not (signal.is_noisy or signal.is_command):
        return None
    here = np.zeros(len(signal.values), dtype=np.bool_)
    faults = []
    for end in (np.min(signal.values), np.max(signal.values)):
        at = signal.values == end
        if not _is_cut_off(signal, at, end, in_doubt):
            continue
        for first, last in joined(signal, at):
            here[first : last + 1] = True
            faults.append(
                Fault(
                    signal.name, "saturated", float(signal.time[first]), float(signal.time[last]),
                    f"at the end of its range, {end:.4g} {signal.channel.unit}",
                    "log all of it" if signal.is_command else "give the sensor a wider range",
                )
            )  # fmt: skip
    return Found(faults, signal.lost(here)) if faults else None


def _is_cut_off(signal: Signal, at: Flags, end: float, in_doubt: bool) -> bool:
    if np.sum(at) < OFTEN:
        return False
    runs = covered(at)
    longest = max(last - first + 1 for first, last in runs)
    if longest < (IN_A_ROW if len(runs) > 1 else signal.longest_repeat):
        return False
    others = signal.values[~at]
    nearest = others[np.argmin(np.abs(others - end))]
    if np.sum(at) < MORE * np.sum(others == nearest):
        return False
    return not signal.is_command or _is_clipped(signal, runs, in_doubt)


def _is_clipped(signal: Signal, runs: list[tuple[int, int]], in_doubt: bool) -> bool:
    """Whether a command reaches its extreme and leaves it again at speed. One that rests at times may do so by itself:
    it was clipped only if it is in doubt, and does not leap there, as a square wave does."""
    moves = np.abs(signal.steps)
    usual = float(np.median(moves[moves > 0.0]))
    entered = [(first - 1, first - 2) for first, _ in runs if first > 1]
    left = [(last, last + 1) for _, last in runs if last + 1 < len(moves)]
    if not entered + left:
        return False
    inside = sum(last - first for first, last in runs)
    if np.sum(moves == 0.0) - inside <= 0.05 * len(moves):
        return bool(np.median([moves[edge] for edge, _ in entered + left]) > 0.1 * usual)
    return in_doubt and bool(np.median([np.min(moves[list(edge)]) for edge in entered + left]) > 0.1 * usual)
