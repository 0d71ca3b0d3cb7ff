"""A position whose zero or scale leaps, and which goes on from there: a sensor that slipped, a unit that changed.

The piston cannot leap. Which side of a leap is right the recording does not say; the longer one is used.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.noise import Integers
from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

BESIDE = 4
"""Changes to either side of a leap that must be far smaller."""
AT_AN_EDGE = 2
"""Samples at the start and at the end that may be anything: a node's first message may be made before any sample."""
ALONE = 0.25
"""Share of a leap that they may have."""


def find(signal: Signal) -> Found | None:
    """The shorter side of a leap."""
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
                f"its zero or scale is another one there: it leaps by {abs(leap):.4g} {signal.channel.unit}",
                "see what moved the sensor or changed its unit",
            )
        )  # fmt: skip
    return Found(faults, signal.lost(here))


def leaps_of(signal: Signal) -> Integers:
    """After which samples a position leaps, and stays."""
    if signal.channel.unit != "m":
        return np.zeros(0, dtype=np.int64)
    steps = np.abs(signal.steps)
    leaps = np.flatnonzero(steps > signal.jump)
    chosen = [place for place in leaps if AT_AN_EDGE < place < len(steps) - AT_AN_EDGE and _is_alone(steps, place)]
    return np.array(chosen, dtype=np.int64)


def _is_alone(steps: FloatArray, place: int) -> bool:
    beside = np.concatenate([steps[max(0, place - BESIDE) : place], steps[place + 1 : place + 1 + BESIDE]])
    return bool(len(beside) == 0 or np.max(beside) < ALONE * steps[place])
