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
"""Largest difference of copies without noise, as a share of the signal's variation: rounding, and separate stamps."""
WHITE = 1.05
"""Largest ratio of white noise's variation to that of its successive differences over root 2."""
MISSING = 0.25
"""Share of the pressure difference that moves the nominal piston, below which two pressures do not show it."""


def copies(recording: Recording) -> Suspect | None:
    """A pair of identical channels, if there is one, corrected by leaving out the second."""
    for channel, other in combinations(recording.channels.values(), 2):
        if channel.unit != other.unit:
            continue
        difference = channel.values - np.interp(channel.time, other.time, other.values)
        identical = float(np.ptp(difference)) + abs(float(np.mean(difference))) <= IDENTICAL * float(
            np.ptp(channel.values)
        )
        if identical and np.ptp(channel.values) > 0.0:
            return _recorded_twice(channel.name, other.name)
    return None


def noisy_copies(recording: Recording, nominal: Mapping[str, float]) -> Suspect | None:
    """The two pressures, if they differ by noise alone and by less than the motion requires.

    This compares the scales of pressures and position, and therefore holds only if the units of both are right.
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
    """Whether a difference is white noise about zero."""
    spread = float(np.std(difference))
    white = float(np.std(np.diff(difference))) / sqrt(2.0)
    return spread <= WHITE * white and abs(float(np.mean(difference))) <= 4.0 * spread / sqrt(len(difference))


def _moves_nothing(recording: Recording, nominal: Mapping[str, float]) -> bool:
    """Whether the smoothed pressures differ by far less than the recorded motion requires."""
    signals = on_grid(recording)
    if signals is None:
        return False
    force = nominal["moving_mass"] * signals.acceleration + nominal["damping_coefficient"] * signals.speed
    difference = signals.channels["pressure_a"] - signals.channels["pressure_b"]
    return bool(np.std(difference) < MISSING * np.std(force) / nominal["piston_area"])
