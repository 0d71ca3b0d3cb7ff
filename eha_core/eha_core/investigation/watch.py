"""Whether a rig that moves is about to pass a limit, from what it measures."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import isfinite

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.quantities import quantity

AHEAD = 0.05
"""s that are looked ahead: zero voltage takes effect within some hundredths of a second (assumed)."""

WINDOW = 0.02
"""s over which the speed is measured; at 500 Hz noise of 10 um makes 1 mm/s of it."""

IN_SIGHT = 0.95
"""Share of the largest pressure at which it is in sight (assumed); it rises too fast to be looked ahead for."""


class Watch:
    """Follows a motion's samples and says in one line what is in sight.

    Args:
        limits: of position, speed and pressure; energy and voltage are planned and not watched.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._positions: deque[tuple[float, float]] = deque()

    def trouble(self, time: float, position: float, pressures: Mapping[str, float]) -> str:
        """What of this sample would pass a limit soon; empty if nothing does.

        Args:
            time: [s]. position: from mid stroke [m]. pressures: gauge [Pa], by channel, those that are measured.
        """
        measured = {"position": position, **pressures}
        for name, value in measured.items():
            if not isfinite(value):
                return f"{name.replace('_', ' ')} is {value}"
        speed = self._speed(time, position)
        if abs(position + AHEAD * speed) >= self._limits.position:
            moving = f"position {quantity(position, 'm')}, moving at {quantity(speed, 'm/s')}"
            return f"{moving}: the limit of {quantity(self._limits.position, 'm')} is in sight"
        if abs(speed) >= self._limits.speed:
            return f"speed {quantity(speed, 'm/s')}: the limit is {quantity(self._limits.speed, 'm/s')}"
        for name, value in pressures.items():
            if value >= IN_SIGHT * self._limits.pressure:
                limit = quantity(self._limits.pressure, "Pa")
                return f"{name.replace('_', ' ')} {quantity(value, 'Pa')}: the limit of {limit} is in sight"
        return ""

    def _speed(self, time: float, position: float) -> float:
        """Mean velocity over the window [m/s]; zero until it has a second sample."""
        self._positions.append((time, position))
        while len(self._positions) > 2 and time - self._positions[1][0] >= WINDOW:
            self._positions.popleft()
        before, at = self._positions[0]
        return (position - at) / (time - before) if time > before else 0.0
