"""What a position controller sees, and what it is to follow."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import NamedTuple


class Measurement(NamedTuple):
    """What the rig says of one instant, as joint_states carries it."""

    position: float
    """Piston position [m]."""
    velocity: float
    """Piston velocity [m/s]."""
    force: float
    """Pressure force on the piston, A (P1 - P2) [N]."""


class Target(NamedTuple):
    """Where the piston should be at the same instant, as `reference` carries it."""

    position: float
    """Position [m]."""
    velocity: float
    """Velocity [m/s]."""


class Controller(ABC):
    """A law that answers each measurement with one voltage.

    Args:
        parameters: the actuator's parameters by catalogue name, as far as they are known.
        period: time between two commands [s].
        largest: largest voltage that the drive takes, either sign [V].
    """

    def __init__(self, parameters: Mapping[str, float], period: float, largest: float) -> None:
        self._parameters = dict(parameters)
        self._period = period
        self._largest = largest
        self.reset()

    @abstractmethod
    def reset(self) -> None:
        """Forget what was seen."""

    @abstractmethod
    def voltage(self, measured: Measurement, target: Target) -> float:
        """Return the voltage of the next period [V]."""

    def _limited(self, voltage: float) -> float:
        return min(max(voltage, -self._largest), self._largest)
