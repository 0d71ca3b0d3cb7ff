"""The voltages that a plant remembers: one a step in a ring, for effects that read the command back.

Of plants in lock-step under one command there is one ring; where each lane has a command of its own, the lanes' rings
follow each other in one array.
"""

from __future__ import annotations

from eha_core.compiled import inlined

LONGEST_DELAY = 0.25
"""s; how far back the plant remembers its command. The command delay's upper bound."""


@inlined
def ring_size(step_size):
    """Places of one ring: the steps of LONGEST_DELAY, two for what lies between, and the newest one's index."""
    return int(LONGEST_DELAY / step_size) + 3


@inlined
def rings_in(history, step_size):
    """How many rings an array holds: 1, or one a lane."""
    return max(1, history.shape[0] // ring_size(step_size))


@inlined
def ring_of(history, lane, step_size):
    """The ring that a lane reads."""
    if rings_in(history, step_size) == 1:
        return history
    size = ring_size(step_size)
    return history[lane * size : (lane + 1) * size]
