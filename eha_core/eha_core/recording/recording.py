"""What a recording is once it has been read: channels in SI units on one time axis, and what was said about them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from eha_core.recording.channel_rules import ChannelRule

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
        ChannelKind("pump_speed", "rad/s", "speed of the pump that feeds the cylinder", 1e5),
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
        rule: how it was taken from there; None where it was no file's.
    """

    name: str
    time: FloatArray
    values: FloatArray
    unit: str
    topic: str
    type: str
    rule: ChannelRule | None = None


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
        parts: the actuator's parts by kind, as a nominal file has them under `plant:`; empty where none were stored.
    """

    path: Path
    channels: Mapping[str, Channel]
    start_stamp: int
    duration: float
    parameters: Mapping[str, float]
    leakage_changes: tuple[tuple[float, float], ...]
    damaged: str | None
    remarks: tuple[str, ...]
    parts: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_arrays(
        cls, *, time: ArrayLike, pressures: str = "absolute", name: str = "in memory", **channels: ArrayLike
    ) -> Recording:
        """A recording from arrays, in SI units: any of CHANNEL_KINDS by keyword, one value for each time.

        Args:
            time: (n,) instants [s].
            pressures: whether pressures are "absolute" or "gauge" [Pa].
            name: what the recording is called in reports.
            channels: voltage_command [V], position [m], velocity [m/s], pressure_a, pressure_b [Pa], force [N] ...

        Raises:
            RecordingError: an array of another length, an unknown channel, or numbers that can only be in another unit.
        """
        from eha_core.recording.arrays import from_arrays

        return from_arrays(time, channels, pressures, name)

    @classmethod
    def from_dataframe(
        cls,
        frame: Any,
        columns: Mapping[str, str] | None = None,
        time: str | None = None,
        pressures: str = "absolute",
        name: str = "in memory",
    ) -> Recording:
        """A recording from a data frame of pandas or Polars whose columns are named like channels.

        Args:
            frame: one row for each instant, in SI units.
            columns: the column of each channel that has another name, as {"position": "x_piston"}.
            time: the column with the times; by default `time`, else the frame's index. Dates count from the first.
            pressures: whether pressures are "absolute" or "gauge" [Pa].
            name: what the recording is called in reports.

        Raises:
            RecordingError: a column that is not there, or what `from_arrays` refuses.
        """
        from eha_core.recording.arrays import from_dataframe

        return from_dataframe(frame, columns or {}, time, pressures, name)

    def to_dict(self) -> dict[str, FloatArray]:
        """The channels as arrays over one time axis, that of the channel with most samples, ready for a data frame.

        Voltage is held between its samples, everything else is interpolated; pressures are gauge.
        """
        longest = max(self.channels.values(), key=lambda channel: len(channel.time))
        found = {"time": longest.time}
        for name, channel in self.channels.items():
            held = np.clip(np.searchsorted(channel.time, longest.time, side="right") - 1, 0, None)
            is_held = name == "voltage_command"
            found[name] = channel.values[held] if is_held else np.interp(longest.time, channel.time, channel.values)
        return found
