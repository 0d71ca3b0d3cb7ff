"""What a recording is once it has been read: channels in SI units on one time axis, and what was said about them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class ChannelKind:
    """What a channel name means: its unit, and the largest magnitude of any rig, a guard against wrong units."""

    name: str
    unit: str
    meaning: str
    largest: float

    @property
    def is_pressure(self) -> bool:
        """Whether the channel is a pressure, so that absolute and gauge differ."""
        return self.unit == "Pa"


CHANNEL_KINDS: dict[str, ChannelKind] = {
    kind.name: kind
    for kind in (
        ChannelKind("voltage_command", "V", "voltage at the valve's coil", 1e4),
        ChannelKind("current", "A", "coil current", 1e3),
        ChannelKind("spool", "A", "spool position, ampere-equivalent", 1e3),
        ChannelKind("flow_a", "m^3/s", "flow into chamber 1", 10.0),
        ChannelKind("flow_b", "m^3/s", "flow out of chamber 2", 10.0),
        ChannelKind("pressure_a", "Pa", "pressure of chamber 1, gauge", 1e9),
        ChannelKind("pressure_b", "Pa", "pressure of chamber 2, gauge", 1e9),
        ChannelKind("supply_pressure", "Pa", "supply pressure, gauge", 1e9),
        ChannelKind("position", "m", "piston position", 50.0),
        ChannelKind("velocity", "m/s", "piston velocity", 100.0),
        ChannelKind("force", "N", "force of the pressures on the piston", 1e9),
    )
}


@dataclass(frozen=True)
class Channel:
    """One measured quantity.

    Attributes:
        name: a key of CHANNEL_KINDS.
        time: strictly increasing, relative to the recording's first stamp [s].
        values: finite samples, one for each time, in `unit`; pressures are gauge.
        unit: SI unit as text.
        topic: topic, or CSV column, that it came from.
        type: message type, or "csv".
    """

    name: str
    time: FloatArray
    values: FloatArray
    unit: str
    topic: str
    type: str


@dataclass(frozen=True)
class Recording:
    """A recording as the rest of the library sees it.

    Attributes:
        path: where it was read from.
        channels: what was measured, by channel name, in the order of CHANNEL_KINDS.
        start_stamp: the first stamp of any channel [ns].
        duration: from the first to the last sample of any channel [s].
        parameters: the nominal parameters that the recorder stored, by name [SI]; empty where it stored none.
        leakage_changes: (time [s], coefficient [m^3/(s Pa)]) of each message on `internal_leakage`.
        damaged: which part of a damaged file could be read; None where the file is sound.
        remarks: what was kept out or put right while reading, one line each.
    """

    path: Path
    channels: Mapping[str, Channel]
    start_stamp: int
    duration: float
    parameters: Mapping[str, float]
    leakage_changes: tuple[tuple[float, float], ...]
    damaged: str | None
    remarks: tuple[str, ...]
