"""The task of an error budget: to follow a reference under a controller, or to respond to a voltage in open loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_core.control import CONTROLLERS, make_controller
from eha_core.control.loop import follow_together
from eha_core.errors import ParameterError, remedy
from eha_core.plant import Composition, simulate_many
from eha_core.signals import Signal

Array = NDArray[np.float64]

LONGEST = 600.0
"""s; a longer task takes minutes and more (assumed)."""


@dataclass(frozen=True)
class Task:
    """A required motion.

    Attributes:
        signal: the reference [m] of a controller, or the voltage [V] without one.
        controller: one of `eha_core.control.CONTROLLERS`, designed for the rig as modelled; empty: open loop. The error
            is then the difference from the motion of the rig as modelled under the same voltage.
        duration: [s].
        skip: seconds to ignore at the start.
        rate: commands, and samples of the error, per second [Hz].
        command_limit: largest voltage of the controller, either sign [V].
        step_size: the plant's step [s].
    """

    signal: Signal
    controller: str = "pid"
    duration: float = 4.0
    skip: float = 1.0
    rate: float = 500.0
    command_limit: float = 10.0
    step_size: float = 1e-4

    def __post_init__(self) -> None:
        """Check the values, alone and in combination."""
        if self.controller and self.controller not in CONTROLLERS:
            raise ParameterError(f"there is no controller {self.controller!r}; {remedy(self.controller, CONTROLLERS)}")
        if not 0.0 <= self.skip < self.duration <= LONGEST:
            raise ParameterError(
                f"duration = {self.duration:g} s and skip = {self.skip:g} s leave nothing to count;"
                f" give 0 <= skip < duration <= {LONGEST:g} s"
            )
        if not self.command_limit > 0.0:
            raise ParameterError(f"command_limit = {self.command_limit:g} V; give a voltage above zero")
        steps = 1.0 / (self.rate * self.step_size) if self.rate > 0.0 else 0.0
        if steps < 0.5 or abs(steps - round(steps)) > 1e-6 * steps:
            raise ParameterError(
                f"rate = {self.rate:g} Hz is not one sample every whole number of steps of {self.step_size:g} s; give"
                " for example 500"
            )

    @property
    def steps(self) -> int:
        """Steps of the plant between two samples."""
        return round(1.0 / (self.rate * self.step_size))

    def rmse(
        self, sets: Sequence[Mapping[str, float]], modelled: Mapping[str, float], composition: Composition
    ) -> Array:
        """Root mean square [m] of the true position's error, for each parameter set (`modelled` are those of the
        controller's design). Raises ParameterError where the reference begins outside the stroke."""
        errors = self._errors(sets, modelled, composition)
        return np.asarray(np.sqrt(np.mean(np.square(errors), axis=1)))

    def _errors(
        self, sets: Sequence[Mapping[str, float]], modelled: Mapping[str, float], composition: Composition
    ) -> Array:
        """Errors [m] after `skip`, (sets, samples)."""
        if not self.controller:
            return self._open_loop(sets, modelled, composition)
        start, stroke = float(self.signal.value(0.0)), min(values["actuator_displacement"] for values in sets)
        if abs(start) > stroke:
            raise ParameterError(f"the reference begins at {start:g} m, outside the stroke of +-{stroke:g} m")
        period = self.steps * self.step_size
        controller = make_controller(self.controller, modelled, period, self.command_limit)
        reached = follow_together(controller, sets, self.signal, self.duration, period, self.step_size, composition)
        wanted = np.asarray(self.signal.value(np.arange(reached.shape[1]) * period))
        return np.asarray((reached - wanted)[:, round(self.skip / period) :])

    def _open_loop(
        self, sets: Sequence[Mapping[str, float]], modelled: Mapping[str, float], composition: Composition
    ) -> Array:
        """The same in open loop, relative to the model's motion under the same voltage."""
        command = np.asarray(self.signal.value(np.arange(round(self.duration / self.step_size)) * self.step_size))
        reached = _positions([modelled, *sets], command, self.steps, self.step_size, composition)
        return np.asarray((reached[1:] - reached[0])[:, round(self.skip * self.rate) :])


def _positions(
    sets: Sequence[Mapping[str, float]], command: Array, every: int, step_size: float, composition: Composition
) -> Array:
    """Positions [m] under one voltage, (sets, samples)."""
    named = [composition.named(values) for values in sets]
    return simulate_many(
        named, command, step_size=step_size, every=every, columns=("position",), composition=composition
    ).position
