"""The known channels: the meaning and SI unit of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class ChannelKind:
    """A channel's name, unit and meaning, and the largest magnitude on any rig, which detects wrong units."""

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
        ChannelKind("flow_a", "m^3/s", "flow into chamber A", 10.0),
        ChannelKind("flow_b", "m^3/s", "flow out of chamber B", 10.0),
        ChannelKind("pressure_a", "Pa", "pressure of chamber A, gauge", 1e9),
        ChannelKind("pressure_b", "Pa", "pressure of chamber B, gauge", 1e9),
        ChannelKind("pump_speed", "rad/s", "speed of the pump that feeds the cylinder", 1e5),
        ChannelKind("supply_pressure", "Pa", "supply pressure, gauge", 1e9),
        ChannelKind("position", "m", "piston position", 50.0),
        ChannelKind("velocity", "m/s", "piston velocity", 100.0),
        ChannelKind("force", "N", "force of the pressures on the piston", 1e9),
        ChannelKind("schedule", "", "what coefficients may depend on, in a unit of its own", 1e12),
    )
}
