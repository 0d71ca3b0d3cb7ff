"""Gaps of a channel: the intervals in which its samples are missing.

While a command is lost for longer than some of its periods, the valve's voltage is not known, and the piston's motion
cannot be used. A sensor's gap only means fewer samples; it is reported where it is long.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault
from eha_core.health.signal import COMMANDS
from eha_core.recording import Channel, Recording

PERIODS = 5.0
"""Periods after which a missing command counts as lost: a busy computer delays a message by two or three (assumed)."""
REGULAR = 0.8
"""Share of the intervals that must be within a quarter of the usual one in a periodic command. One that is sent only
where it changes has no gaps."""
FEWEST = 50
"""Fewest samples of a command with a period."""
SENSOR_PERIODS, SENSOR_SECONDS = 60.0, 0.25
"""Shortest gap of a sensor that is reported, in periods and in seconds: a busy network loses bursts of 50 samples."""


def holes(channel: Channel, recording: Recording) -> list[Fault]:
    """The intervals in which a channel's samples are missing."""
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
