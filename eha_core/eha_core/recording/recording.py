"""A recording after reading: channels in SI units on one time axis, with parameters and remarks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eha_core.recording import arrays
from eha_core.recording.assembly import Assembled, Channel
from eha_core.recording.channel_kinds import CHANNEL_KINDS, ChannelKind, FloatArray

__all__ = ["CHANNEL_KINDS", "Channel", "ChannelKind", "FloatArray", "Recording"]


@dataclass(frozen=True)
class Recording(Assembled):
    """A recording as the rest of the library uses it; its attributes are those of `Assembled`."""

    @classmethod
    def of(cls, parts: Assembled) -> Recording:
        """A recording of assembled channels."""
        return cls(**{row.name: getattr(parts, row.name) for row in fields(parts)})

    @classmethod
    def from_arrays(
        cls, *, time: ArrayLike, pressures: str = "absolute", name: str = "in memory", **channels: ArrayLike
    ) -> Recording:
        """A recording from arrays, in SI units: any of CHANNEL_KINDS by keyword, one value for each time.

        Args:
            time: (n,) instants [s].
            pressures: whether pressures are "absolute" or "gauge" [Pa].
            name: the recording's name in reports.
            channels: voltage_command [V], position [m], velocity [m/s], pressure_a, pressure_b [Pa], force [N] ...

        Raises:
            RecordingError: an array of another length, an unknown channel, or numbers that must be in another unit.
        """
        return cls.of(arrays.from_arrays(time, channels, pressures, name))

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
            name: the recording's name in reports.

        Raises:
            RecordingError: a column is missing, or the errors of `from_arrays`.
        """
        return cls.of(arrays.from_dataframe(frame, columns or {}, time, pressures, name))

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
