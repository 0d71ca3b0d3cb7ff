"""The checks of each channel, in their order: each sees the samples that the earlier ones did not exclude."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from eha_core.health.clock import drift
from eha_core.health.coverage import holes
from eha_core.health.fault import Fault, Found, Health
from eha_core.health.faults import (
    dropped,
    frozen,
    held,
    hum,
    interpolated,
    jump,
    low_passed,
    noisy,
    rescaled,
    saturated,
    spikes,
    wrapped,
)
from eha_core.health.rate import too_slow
from eha_core.health.signal import Signal
from eha_core.health.still import still
from eha_core.plant import Composition
from eha_core.recording import Recording

Check = Callable[[Signal], Found | None]
CHECKS: tuple[Check, ...] = (
    dropped.find, saturated.find, held.find, interpolated.find, frozen.find, rescaled.find, wrapped.find, jump.find,
    noisy.find, spikes.find, hum.find, low_passed.find,
)  # fmt: skip
"""The more specific checks come first: a fill value is not a jump, and the end of a range is not a frozen sensor."""

IN_DOUBT: dict[Check, Check] = {saturated.find: saturated.find_in_doubt, frozen.find: frozen.find_in_doubt}
DOUBTING = tuple(IN_DOUBT.get(check, check) for check in CHECKS)
"""The same where a command is taken to be clipped or frozen wherever it may be."""

UNCHECKED = ("velocity",)
"""Channels that no fit uses."""
FEWEST = 100
"""Fewest samples from which a channel's usual noise and motion are known."""


def examine(recording: Recording, checks: Sequence[Check] = CHECKS) -> Health:
    """Find the faults that each channel shows by itself."""
    faults: list[Fault] = []
    lost, values = {}, {}
    for name, channel in recording.channels.items():
        if name in UNCHECKED:
            continue
        faults += holes(channel, recording)
        if len(channel.time) < FEWEST or not np.ptp(channel.values) > 0.0:
            continue
        signal, gone = Signal.of(channel), np.zeros(len(channel.time), dtype=np.bool_)
        for check in checks:
            found = check(signal)
            if found is None or not found.faults:
                continue
            faults += found.faults
            gone |= found.lost
            if found.values is not None:
                values[name] = found.values
                signal = Signal(replace(channel, values=found.values), signal.places)
            signal = signal.without(found.lost)
            if len(signal.time) < FEWEST:
                break
        if gone.any():
            lost[name] = gone
    return Health(tuple(faults), lost, values)


def unsuited(recording: Recording, nominal: Mapping[str, float], composition: Composition) -> tuple[Fault, ...]:
    """The faults that show only between channels or against the nominal plant: a log too slow for its valve, a piston
    that should have moved, a clock that runs at another rate."""
    return (
        *too_slow(recording, nominal, composition), *still(recording, nominal, composition), *drift(recording),
    )  # fmt: skip
