"""Whether a piston moves that its command should have moved.

The means of blocks of a position at rest scatter as white noise of the samples says, within a factor of two in power:
over 20 blocks and more that is one sound recording in a thousand whose piston moves by as little as its noise, and none
whose motion shows. A small command is no fault: a valve's overlap and hysteresis may take all of it, and that
is what such a recording tells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eha_core.health.fault import Fault
from eha_core.health.signal import Signal
from eha_core.plant import Composition
from eha_core.recording import Recording

SECONDS, FEWEST = 0.1, 20
"""A block's length and how many there are at least."""
MOTION = 2.0
"""Power of the means over that of noise from which on there is motion."""
TAKEN = 0.05
"""Share of the rated command, from its lowest value to its highest, that a sound valve may take (assumed: 1 % of
overlap either way and 3 % of hysteresis, which servo valves' data sheets allow)."""


def still(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> Sequence[Fault]:
    """The position, where it is a constant and noise under a command that should have moved the piston."""
    channel = recording.channels.get("position")
    if channel is None or len(channel.time) < 2 * FEWEST or not np.ptp(channel.values) > 0.0:
        return ()
    signal = Signal.of(channel)
    if not signal.is_noisy or not _rests(signal) or _is_small(recording, nominal, composition):
        return ()
    spans = 1e6 * float(np.ptp(signal.values))
    fault = Fault(
        signal.name, "still", float(signal.time[0]), float(signal.time[-1]),
        f"does not move: it spans {spans:.3g} um, all of it noise",
        "see whether the piston or its sensor is stuck, and record a test that moves it", False, True,
    )  # fmt: skip
    return (fault,)


def _rests(signal: Signal) -> bool:
    count = int((signal.time[-1] - signal.time[0]) / SECONDS)
    if count < FEWEST:
        return False
    length = len(signal.values) // count
    means = signal.values[: count * length].reshape(count, length).mean(axis=1)
    return bool(np.var(means) * length <= MOTION * signal.noise**2)


def _is_small(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> bool:
    """Whether the command hardly opens the valve; of a source without one nothing is known."""
    channel = recording.channels.get("voltage_command")
    if channel is None or composition.source.valve != "coil" or not len(channel.values):
        return False
    rated = nominal["saturation_current"] * nominal["coil_resistance"]
    return float(np.ptp(channel.values)) < TAKEN * rated
