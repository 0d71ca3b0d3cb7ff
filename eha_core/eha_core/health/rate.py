"""Whether the command was logged often enough for the valve that it moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eha_core.health.fault import Fault
from eha_core.plant import Composition
from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

COMMAND = "voltage_command"


def too_slow(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> Sequence[Fault]:
    """A fault of the command, where its sampling delays it by more than coil and spool do; empty without one.

    A command held from sample to sample is late by half a period on average if the drive received more samples. That
    hides the valve's own delay, L / R + 2 zeta / omega, once the period is twice that.
    """
    channel = recording.channels.get(COMMAND)
    if channel is None or composition.source.valve != "coil" or len(channel.time) < 2:
        return ()
    period = float(np.median(np.diff(channel.time)))
    coil = nominal["coil_inductance"] / nominal["coil_resistance"]
    delay = coil + 2.0 * nominal["valve_damping_ratio"] / nominal["valve_natural_frequency"]
    if period < 2.0 * delay or _is_made_of_steps(channel.values):
        return ()
    fault = Fault(
        COMMAND, "too_slow", float(channel.time[0]), float(channel.time[-1]),
        f"logged at {1.0 / period:.3g} Hz, too slowly for a valve that acts within {1e3 * delay:.2g} ms",
        f"log it at {np.ceil(0.5 / delay / 10.0) * 10.0:.0f} Hz or more, or at each change", False, True,
    )  # fmt: skip
    return (fault,)


def _is_made_of_steps(values: FloatArray) -> bool:
    """Whether a command is constant most of the time: then each message is a change, however rare."""
    return bool(np.mean(np.diff(values) == 0.0) > 0.5)
