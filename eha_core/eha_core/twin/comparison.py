"""What a twin is set to, and what it says of one window."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

DRIFT = "position"
"""Named where the position leaves the model though no equation alone departs beyond noise: a slow error adds up."""

FROZEN, STALE = "frozen", "stale"
"""What a channel is that stands still to the last digit though it has noise, and one that brings nothing any more."""


@dataclass(frozen=True)
class Settings:
    """What a twin is set to beside the plant's parameters.

    Attributes:
        window: time after which the model is put back to the measured state [s].
        threshold: how many times the noise an equation, or the position, may be off.
        false_alarm_hours: mean time until one of them seems to be off by more by chance [h].
        position_noise, pressure_noise: least noise reckoned with [m], [Pa]; more is read off the data.
        command_timeout: time without a command after which the drive's voltage is zero [s]; 0: never.
        command_limit: largest voltage the drive takes [V].
        kept: time over which what was compared is kept, to name a departure and to record it [s].
    """

    window: float = 1.0
    threshold: float = 1.5
    false_alarm_hours: float = 10_000.0
    position_noise: float = 10e-6
    pressure_noise: float = 1e4
    command_timeout: float = 0.5
    command_limit: float = 10.0
    kept: float = 10.0


@dataclass(frozen=True)
class Comparison:
    """What one window showed.

    Attributes:
        start, end: the window's stamps [ns].
        errors: RMS of measured minus simulated of each channel there was [SI].
        noises: standard deviation of the noise of each of these channels [SI].
        ratios: for each equation that could be examined, and for DRIFT, the RMS of its residual over its noise.
        departs: what departs beyond the threshold, the most first, and from which stamp on, through all windows
            since [ns]. DRIFT is among them only where no equation is suspicious.
        unsound: the channels that are FROZEN or STALE, and since which stamp [ns]; nothing is compared with them.
    """

    start: int
    end: int
    errors: Mapping[str, float]
    noises: Mapping[str, float]
    ratios: Mapping[str, float]
    departs: Mapping[str, int]
    unsound: Mapping[str, tuple[str, int]] = field(default_factory=dict)
