"""Whether the piston moved where its command should have moved it.

At rest, the means of blocks of the position scatter as expected from the samples' white noise, within a factor of two
in power. With 20 blocks and more, one sound recording in a thousand is reported whose motion is as small as its noise,
and none whose motion is visible. A small command is not a fault, because a valve's overlap and hysteresis may absorb
all of it, or friction may hold the piston; unless the pressures are those of the nominal plant, whose piston moves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from eha_core.health.fault import Fault
from eha_core.health.signal import Signal
from eha_core.plant import Composition, Plant
from eha_core.recording import Channel, Recording

SECONDS, FEWEST = 0.1, 20
"""Length of a block, and fewest blocks."""
MOTION = 2.0
"""Power of the means, over that expected of noise, from which there is motion."""
TAKEN = 0.05
"""Range of the command, as a share of the rated one, that a sound valve may absorb (assumed: 1 % of overlap either way
and 3 % of hysteresis, which servo valves' data sheets allow)."""
STEP, EVERY, SIMULATED = 2e-4, 5, 60.0
"""s, of the nominal plant's simulation, steps from one of its rows to the next, and how much of a recording it is run
over at most [s]: a piston that moves at all shows in a minute, and an hour would take gigabytes (assumed)."""


def still(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> Sequence[Fault]:
    """A fault of the position, if it is a constant with noise under a command that should have moved it; else empty."""
    channel = recording.channels.get("position")
    if channel is None or len(channel.time) < 2 * FEWEST or not np.ptp(channel.values) > 0.0:
        return ()
    signal = Signal.of(channel)
    if not signal.is_noisy or not _rests(signal):
        return ()
    if _is_small(recording, nominal, composition) and not _oil_moved(recording, nominal, composition):
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
    """Whether the command hardly opens the valve; it is not known for a source without a valve."""
    channel = recording.channels.get("voltage_command")
    if channel is None or composition.source.valve != "coil" or not len(channel.values):
        return False
    rated = nominal["saturation_current"] * nominal["coil_resistance"]
    return float(np.ptp(channel.values)) < TAKEN * rated


def _oil_moved(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> bool:
    """Whether the pressures change, and do so as in the nominal plant, down to their noise, while its piston moves."""
    channels = {name: _begun(channel) for name, channel in recording.channels.items()}
    command, position = channels["voltage_command"], channels["position"]
    pressures = [channels[name] for name in ("pressure_a", "pressure_b") if name in channels]
    if not pressures or any(len(channel.time) < 2 * FEWEST for channel in (command, position, *pressures)):
        return False
    steps = STEP * np.arange(round(command.time[-1] / STEP))
    held = command.values[np.maximum(np.searchsorted(command.time, steps, "right") - 1, 0)]
    stroke = nominal["actuator_displacement"]
    start = float(np.clip(np.median(position.values), -stroke, stroke))
    moved = Plant(nominal, STEP, start, composition).run(held, EVERY)

    def rests_beside_it(channel: Channel) -> bool:
        modelled = np.interp(channel.time, moved.time, getattr(moved, channel.name))
        return _rests(Signal.of(replace(channel, values=channel.values - modelled)))

    if rests_beside_it(position):
        return False
    return all(rests_beside_it(channel) and not _rests(Signal.of(channel)) for channel in pressures)


def _begun(channel: Channel) -> Channel:
    """The beginning of a channel, as much of it as is simulated."""
    first = channel.time < SIMULATED
    return replace(channel, time=channel.time[first], values=channel.values[first])
