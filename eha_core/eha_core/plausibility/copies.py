"""Channels that are copies of each other: one sensor recorded under two names."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from math import sqrt

import numpy as np

from eha_core.plausibility.finding import Suspect
from eha_core.plausibility.signals import on_grid
from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

IDENTICAL = 1e-6
"""Share of a signal's variation that copies without noise may differ by: rounding, and stamps of their own."""
WHITE = 1.05
"""Ratio of a signal's variation to that of its successive differences over root 2, up to which it is mere noise."""
MISSING = 0.25
"""Share of the difference that moving the nominal piston takes, below which two pressures do not differ by it."""


def copies(recording: Recording) -> Suspect | None:
    """The pair of channels that tell the same to the last digit, if there is one; without the second of them."""
    for channel, other in combinations(recording.channels.values(), 2):
        if channel.unit != other.unit:
            continue
        difference = channel.values - np.interp(channel.time, other.time, other.values)
        identical = (
            float(np.ptp(difference)) + abs(float(np.mean(difference))) <= IDENTICAL * float(np.ptp(channel.values))
        )
        if identical and np.ptp(channel.values) > 0.0:
            return _recorded_twice(channel.name, other.name)
    return None


def noisy_copies(recording: Recording, nominal: Mapping[str, float]) -> Suspect | None:
    """The two pressures, if they differ by noise alone and by less than the motion takes.

    That compares the pressures' scale with the position's: it holds where neither has another unit.
    """
    channel, other = (recording.channels.get(name) for name in ("pressure_a", "pressure_b"))
    if channel is None or other is None:
        return None
    difference = channel.values - np.interp(channel.time, other.time, other.values)
    alike = _is_noise(difference) and _moves_nothing(recording, nominal)
    return _recorded_twice(channel.name, other.name) if alike else None


def _recorded_twice(name: str, other: str) -> Suspect:
    return Suspect(f"{name} and {other} are one signal recorded twice", {other: None})


def _is_noise(difference: FloatArray) -> bool:
    """Whether a difference is white, about zero."""
    spread = float(np.std(difference))
    white = float(np.std(np.diff(difference))) / sqrt(2.0)
    return spread <= WHITE * white and abs(float(np.mean(difference))) <= 4.0 * spread / sqrt(len(difference))


def _moves_nothing(recording: Recording, nominal: Mapping[str, float]) -> bool:
    """Whether the pressures, smoothed, differ by far less than it takes to move the piston as it was moved."""
    signals = on_grid(recording)
    if signals is None:
        return False
    force = nominal["moving_mass"] * signals.acceleration + nominal["damping_coefficient"] * signals.speed
    difference = signals.channels["pressure_a"] - signals.channels["pressure_b"]
    return bool(np.std(difference) < MISSING * np.std(force) / nominal["piston_area"])
