"""A position whose zero or scale jumps and stays changed: a sensor that slipped, a unit that changed.

The piston cannot jump. The recording does not show which side of a jump is right; the longer one is used.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Integers
from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

BESIDE = 4
"""Changes on either side of a jump that must be far smaller."""
AT_AN_EDGE = 2
"""Samples at the start and at the end that are ignored: a node may send its first message before any sample."""
ALONE = 0.25
"""Largest change next to a jump, as a share of it."""


def find(signal: Signal) -> Found | None:
    """The shorter side of a jump."""
    leaps = leaps_of(signal)
    if not len(leaps):
        return None
    edges = np.concatenate([[0], leaps + 1, [len(signal.values)]])
    kept = int(np.argmax(np.diff(edges)))
    here = np.ones(len(signal.values), dtype=np.bool_)
    here[edges[kept] : edges[kept + 1]] = False
    faults = []
    for first, end in zip(edges[:-1], edges[1:], strict=True):
        if first == edges[kept]:
            continue
        leap = signal.steps[first - 1] if first > edges[kept] else signal.steps[end - 1]
        faults.append(
            Fault(
                signal.name, "jump", float(signal.time[first]), float(signal.time[end - 1]),
                f"its zero or scale changes: it jumps by {abs(leap):.4g} {signal.channel.unit}",
                "see what moved the sensor or changed its unit",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here))


def leaps_of(signal: Signal) -> Integers:
    """The samples after which a position jumps and stays changed."""
    if signal.channel.unit != "m":
        return np.zeros(0, dtype=np.int64)
    steps = np.abs(signal.steps)
    leaps = np.flatnonzero(steps > signal.jump)
    chosen = [place for place in leaps if AT_AN_EDGE < place < len(steps) - AT_AN_EDGE and _is_alone(steps, place)]
    return np.array(chosen, dtype=np.int64)


def _is_alone(steps: FloatArray, place: int) -> bool:
    beside = np.concatenate([steps[max(0, place - BESIDE) : place], steps[place + 1 : place + 1 + BESIDE]])
    return bool(len(beside) == 0 or np.max(beside) < ALONE * steps[place])
