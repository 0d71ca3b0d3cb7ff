"""The motion of a rig in a test: a voltage as a function of time and position until the motion is over."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from eha_core.diagnosis.experiment.limits import Limits
from eha_core.errors import EhaError
from eha_core.investigation.voltage_test import VoltageTest
from eha_core.recording import Recording
from eha_core.signals import make_signal

Motion = Callable[[float, float], float | None]
"""The voltage [V] at an elapsed time [s] and a position [m]; None: the motion is over."""

RETURN_TIME = 0.5
"""s; time constant of the return to mid-stroke: much slower than any valve (assumed)."""

NEAR = 0.05
"""Share of the position's limit within which the piston counts as at mid-stroke (assumed)."""

PATIENCE = 10.0
"""s; longest return: an overlapped valve may not bring the piston all the way (assumed)."""

GENTLE = 0.5
"""Largest speed of the return, as a share of the limit (assumed)."""


class MotionStopped(EhaError):
    """The motion was stopped before its end; the message says why."""


class Rig(Protocol):
    """A rig that moves, records and can be stopped."""

    def run(self, motion: Motion, name: str) -> Recording:
        """Run the motion to its end, set zero voltage, and return its recording under this name.

        Raises MotionStopped, after zero voltage, where a person or a limit stopped it.
        """

    def check(self) -> None:
        """Raise MotionStopped if the rig was stopped while it was at rest."""


def from_mid_stroke(test: VoltageTest, velocity_gain: float, limits: Limits) -> Motion:
    """The slow return to mid-stroke, where a test begins, and then the test, as one motion.

    `velocity_gain`: that of the rig as modelled [(m/s)/V].
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
