"""What a rig is asked to do: a motion, which is a voltage over time and position until it is over."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.errors import EhaError
from eha_core.investigation.voltage_test import VoltageTest
from eha_core.recording import Recording
from eha_core.signals import make_signal

Motion = Callable[[float, float], float | None]
"""The voltage [V] after so many seconds at this position [m]; None: the motion is over."""

RETURN_TIME = 0.5
"""s; time constant with which the piston comes back to mid stroke: much slower than any valve (assumed)."""

NEAR = 0.05
"""Share of the position's limit within which the piston counts as in mid stroke (assumed)."""

PATIENCE = 10.0
"""s after which a return ends where it is: a valve that overlaps may not bring the piston all the way (assumed)."""

GENTLE = 0.5
"""Share of the largest speed with which it comes back at most (assumed)."""


class MotionStopped(EhaError):
    """The motion was stopped before its end; the message says why."""


class Rig(Protocol):
    """A rig that moves, records and can be stopped."""

    def run(self, motion: Motion, name: str) -> Recording:
        """Move to the motion's end and return what was recorded of it under this name, with zero voltage again.

        Raises MotionStopped, after zero voltage, where somebody or a limit stopped it.
        """

    def check(self) -> None:
        """Raise MotionStopped if somebody has stopped the rig since, while it was at rest."""


def from_mid_stroke(test: VoltageTest, velocity_gain: float, limits: Limits) -> Motion:
    """Slowly back to mid stroke, where a test is planned to begin, and then the test; one motion only.

    `velocity_gain`: of the rig as modelled [(m/s)/V].
    """
    signal = make_signal(test.signal.signal, dict(test.signal.parameters))
    largest = min(limits.voltage, GENTLE * limits.speed / velocity_gain)
    began: float | None = None

    def voltage(elapsed: float, position: float) -> float | None:
        nonlocal began
        if began is None and abs(position) > NEAR * limits.position and elapsed < PATIENCE:
            return min(max(-position / (RETURN_TIME * velocity_gain), -largest), largest)
        began = elapsed if began is None else began
        return float(signal.value(elapsed - began)) if elapsed - began < test.duration else None

    return voltage
