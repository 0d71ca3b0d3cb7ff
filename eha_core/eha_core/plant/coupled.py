"""The actuator on a load that another simulation moves: it takes a voltage and a motion, and gives a force."""

from __future__ import annotations

from functools import cache
from math import nan
from typing import NamedTuple

from eha_core.effects import effects
from eha_core.plant.plant_file import require_voltage
from eha_core.plant.simulator import Array, Plant
from eha_core.plant.state import AT, COLUMNS
from eha_core.plant.vector import MOVING_MASS

IMMOVABLE = 1e15
"""kg; a piston that no pressure accelerates by more than 1e-10 m/s in a step (1 m^2 at 1e8 Pa over 1 ms)."""


class Reaction(NamedTuple):
    """What the actuator does to its load over a step.

    Attributes:
        force: of pressures, damping, spring and effects, along positive position [N]. Dry friction is not in it.
        dry_friction: the largest force that opposes motion or holds the load at rest, in addition [N].
        added_mass: what the load's mass is to be enlarged by in this step [kg]. With it the stiffness of the oil and
            the damping act as accurately, and are as stable, as in a plant that moves its own piston.
    """

    force: float
    dry_friction: float
    added_mass: float


class CoupledPlant(Plant):
    """A plant whose piston another simulation moves. That one has the moving mass and the ends of the stroke.

    The other simulation takes semi-implicit Euler steps, v += h F / M and then x += h v. Before each, `reaction` gives
    the force at its start; after it, `follow` takes the pressures along. Its velocities are then those at the middle of
    each step, as of any such scheme, and its positions those at the end.

    Raises ParameterError as `Plant` does, and for a source that no voltage drives or a piston that does not slide.
    """

    def _take(self, values: dict[str, float]) -> None:
        require_voltage(self.composition)
        super()._take(values)
        self._acting_on_load = self._vector
        heavy = list(self._vector)
        heavy[MOVING_MASS] = IMMOVABLE
        self._vector = tuple(heavy)

    def _steps(self, inputs: Array, every: int, rows: Array, active: tuple[bool, ...]) -> None:
        super()._steps(inputs, every, rows, _without_forces(active))

    def reaction(self, mass: float, velocity: float, duration: float) -> Reaction:
        """What the actuator does over a step of `duration` [s] to a load of `mass` [kg] that begins it at `velocity`
        [m/s]. Ask once for each step: effects with a memory advance it.
        """
        self._state[AT.time], self._state[AT.velocity] = self.time, velocity
        acting = self._timetable.acting(self.step_count)
        return Reaction(*self._kernel.reaction(self._state, self._memory, self._acting_on_load, acting, mass, duration))

    def follow(self, voltage: float, start: float, end: float, steps: int = 1) -> None:
        """Hold the voltage [V] for that many of the plant's steps, in which the piston moves steadily from `start` to
        `end` [m]; beyond the stroke it stands at its end. `state` then has no friction force.
        """
        stroke = self._places["actuator_displacement"]
        start, end = (min(max(position, -stroke), stroke) for position in (start, end))
        self._state[AT.position], self._state[AT.velocity] = start, (end - start) / (steps * self.step_size)
        self.advance(voltage, steps)
        self._state[AT.position] = end
        self._row[0, COLUMNS.index("friction_force")] = nan


@cache
def _without_forces(active: tuple[bool, ...]) -> tuple[bool, ...]:
    """The effects that act on oil, valve and sensors: those on the piston are the reaction's."""
    return tuple(acts and effect.site != "force" for acts, effect in zip(active, effects(), strict=True))
