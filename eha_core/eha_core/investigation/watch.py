"""Whether a moving rig is about to exceed a limit, from its measurements."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import isfinite

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.quantities import quantity

AHEAD = 0.05
"""s; prediction horizon: zero voltage takes effect within some hundredths of a second (assumed)."""

WINDOW = 0.02
"""s over which the speed is measured; at 500 Hz, noise of 10 um gives an error of 1 mm/s."""

IN_SIGHT = 0.95
"""Share of the largest pressure at which it counts as in sight (assumed); it rises too fast for a prediction."""


class Watch:
    """Follows a motion's samples and reports a limit in sight in one line.

    Args:
        limits: of position, speed and pressure; energy and voltage are planned, not watched.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._positions: deque[tuple[float, float]] = deque()

    def trouble(self, time: float, position: float, pressures: Mapping[str, float]) -> str:
        """The quantity of this sample that would soon exceed a limit, in words; empty if none would.

        Args:
            time: [s]. position: from mid-stroke [m]. pressures: gauge [Pa], by channel, those that are measured.
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
