"""What a channel covers: the spans in which its samples are missing.

A command that is lost for longer than some of its periods was held by nobody knows whom: what the piston did then is
its answer to a voltage that was not recorded. A sensor's hole is said where it is long; its samples are simply fewer.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault
from eha_core.health.signal import COMMANDS
from eha_core.recording import Channel, Recording

PERIODS = 5.0
"""Periods without a command from which on it was lost: a busy computer delays a message by two or three (assumed)."""
REGULAR = 0.8
"""Share of the intervals within a quarter of the usual one from which on a command is one that comes periodically. One
that is sent only where it changes has no holes."""
FEWEST = 50
"""Samples from which on a command has a period."""
SENSOR_PERIODS, SENSOR_SECONDS = 60.0, 0.25
"""A sensor's hole is said from so many periods and seconds on: bursts of 50 lost samples are a busy network's."""


def holes(channel: Channel, recording: Recording) -> list[Fault]:
    """The spans in which a channel's samples are missing."""
    if len(channel.time) < FEWEST:
        return []
    gaps = np.diff(channel.time)
    period = float(np.median(gaps))
    is_command = channel.name in COMMANDS
    if is_command and np.mean(np.abs(gaps - period) < 0.25 * period) < REGULAR:
        return []
    longest = PERIODS * period if is_command else max(SENSOR_PERIODS * period, SENSOR_SECONDS)
    edges = np.concatenate([channel.time, [recording.duration]])
    return [
        Fault(
            channel.name, "hole", float(edges[place]), float(edges[place + 1]),
            f"no sample for {edges[place + 1] - edges[place]:.3g} s", "record it without interruption", is_command,
        )
        for place in np.flatnonzero(np.diff(edges) > 1.001 * longest)
    ]  # fmt: skip
