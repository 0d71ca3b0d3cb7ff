"""The actuator as an object: parameters in force, state, and time in exact steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from types import MappingProxyType, ModuleType

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.plant.active_intervals import Timetable, intervals, spans
from eha_core.plant.composite import compiled_given_step, compiled_step
from eha_core.plant.composition import PAPER, Composition
from eha_core.plant.memory import start_memory
from eha_core.plant.packing import pack
from eha_core.plant.parts import Source
from eha_core.plant.ring import ring_size
from eha_core.plant.state import AT, COLUMNS, PISTON, Places, Row

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Trajectory:
    """A simulated record: `time` (n,) in s and `values` (n, len(COLUMNS)); each column is an attribute of its name."""

    time: Array
    values: Array

    def __getattr__(self, name: str) -> Array:
        try:
            return self.values[:, COLUMNS.index(name)]
        except ValueError:
            raise AttributeError(name) from None


def check_step_size(step_size: float) -> None:
    """Raise ParameterError for a step [s] that the plant is not made for."""
    if not (isfinite(step_size) and 1e-6 <= step_size <= 1e-3):
        raise ParameterError(f"step_size = {step_size:g} s is out of range; give 1e-6 to 1e-3 s")


def check_voltages(voltages: Array) -> None:
    """Raise ParameterError for a command [V] that is not finite."""
    if not np.all(np.isfinite(voltages)):
        raise ParameterError("the voltage command is not finite; give volts")


def step_inputs(inputs: Array, source: Source) -> Array:
    """What drives a source as the compiled step takes it: (steps,) voltages, or (steps, 2) of what was measured.

    inputs: (steps,) or (steps, inputs), held over each step. Raises ParameterError for another number of them, and for
    values that are not finite.
    """
    inputs = np.ascontiguousarray(inputs, dtype=np.float64)
    if source.valve == "coil":
        check_voltages(inputs)
        return inputs
    least, most = len(source.inputs), len(source.inputs) + len(source.optional)
    columns = inputs[:, None] if inputs.ndim == 1 else inputs
    if not least <= columns.shape[1] <= most:
        names = " and ".join(source.inputs)
        raise ParameterError(f"{source.id} takes {names} for each step; {columns.shape[1]} columns were given")
    if not np.all(np.isfinite(columns)):
        raise ParameterError(f"{' or '.join(source.inputs)} is not finite in some step; give numbers")
    return np.ascontiguousarray(columns[:, [0, columns.shape[1] - 1]])


Moment = tuple[Array, Array, Array, Array, int]
"""All states of a plant, and the steps that it has made."""


class Plant:
    """The electro-hydraulic actuator of equations (1) to (10) with the catalogue's effects, as its parts make it.

    Parameters are those of the composition, the paper's servo valve, double-rod cylinder and sprung mass by default.

    Raises ParameterError for parameters that make no plant, a step that is not 1e-6 to 1e-3 s, or a start outside the
    stroke. The state stays finite and inside the stroke, and absolute pressures at or above zero, for any finite
    input.
    """

    def __init__(
        self,
        parameters: Mapping[str, float] | None = None,
        step_size: float = 1e-4,
        initial_position: float = 0.0,
        composition: Composition = PAPER,
    ) -> None:
        check_step_size(step_size)
        self.step_size = step_size
        self.composition = composition
        self._kernel = _kernel(composition.source)
        self._hidden = [COLUMNS.index(name) for name in composition.source.hides]
        self._take(composition.changed(composition.nominal_values(), parameters or {}))
        self._row = np.zeros((1, len(COLUMNS)))
        self._held = np.empty(0)  # the voltages of a tick, kept from one to the next
        self.reset(initial_position)

    @property
    def parameters(self) -> Mapping[str, float]:
        """Every parameter in force, by its full name."""
        return MappingProxyType(self._values)

    def _take(self, values: dict[str, float]) -> None:
        """Put these values in force."""
        self._values, self._places = values, self.composition.places(values)
        self._vector, self._active, self._propagator = pack(self._places, self.step_size, self.composition)
        found = spans(self._places, self._active, self.step_size)
        self._timetable = Timetable(found)
        on = [span for span, switched_on in zip(found, self._active, strict=True) if switched_on]
        self._all_act = max((begin for begin, _ in on), default=0), min((end for _, end in on), default=inf)

    def set_parameters(self, changes: Mapping[str, float]) -> None:
        """Apply `changes` from the next step on, all of them or, raising ParameterError, none."""
        values = self.composition.changed(self._values, changes)
        before = self._active
        self._take(values)
        self._start_memory([now and not then for now, then in zip(self._active, before, strict=True)])
        stroke = self._places["actuator_displacement"]
        self._state[AT.position] = min(max(self._state[AT.position], -stroke), stroke)

    def reset(self, initial_position: float | None = None) -> None:
        """Back to rest at the initial position and to time zero, both chambers midway between supply and return, or
        at the pressures that hold a cylinder of unequal areas at rest."""
        if initial_position is not None:
            stroke, unit = self._places["actuator_displacement"], self.composition.cylinder.motion
            if not abs(initial_position) <= stroke:
                raise ParameterError(
                    f"initial_position = {initial_position:g} {unit} is outside the stroke of +-{stroke:g} {unit}"
                )
            self._initial_position = initial_position
        source = self.composition.source
        supply, back = self._places["supply_pressure"], self._places["return_pressure"]
        pressures = starting_pressures(self._places, self._initial_position, self.composition)
        self._state = np.zeros(len(Places._fields))
        self._state[AT.supply_pressure], self._state[AT.return_pressure] = back if source.line else supply, back
        self._state[PISTON] = self._initial_position, 0.0, *pressures
        self._history = np.zeros(ring_size(self.step_size))
        self._memory = np.zeros(max(1, sum(len(effect.memory) for effect in effects())))
        self._start_memory([True] * len(effects()))
        self.step_count = 0
        self._row[0] = Row(*[0.0] * len(COLUMNS))._replace(
            position=self._initial_position, pressure_a=pressures[0], pressure_b=pressures[1],
            supply_pressure=self._state[AT.supply_pressure], return_pressure=back,
            internal_leakage=self._places["internal_leakage"], measured_position=self._initial_position,
            measured_pressure_a=pressures[0], measured_pressure_b=pressures[1],
        )  # fmt: skip
        self._row[0, self._hidden] = np.nan

    def place(self, position: float, velocity: float, pressure_a: float, pressure_b: float) -> None:
        """Put piston and chambers into a measured state [SI]; time, valve, and the effects' own states go on."""
        stroke = self._places["actuator_displacement"]
        self._state[PISTON] = min(max(position, -stroke), stroke), velocity, pressure_a, pressure_b

    def moment(self) -> Moment:
        """Everything that goes on from here, to `return_to`."""
        return self._state.copy(), self._history.copy(), self._memory.copy(), self._row.copy(), self.step_count

    def return_to(self, moment: Moment) -> None:
        """Go back to a moment of this plant, its parameters as they are now."""
        for own, then in zip((self._state, self._history, self._memory, self._row), moment, strict=False):
            own[:] = then
        self.step_count = moment[-1]

    def _start_memory(self, chosen: Sequence[bool]) -> None:
        start_memory(self._memory, chosen, self._state[AT.current], self._state[PISTON])

    @property
    def time(self) -> float:
        """Seconds since the last reset: the step count times the step, without accumulated rounding."""
        return self.step_count * self.step_size

    @property
    def state(self) -> Row:
        """The row after the last step; what the source has no value for is not a number."""
        return Row(*self._row[0].tolist())

    def advance(self, given: float | Sequence[float], steps: int) -> None:
        """Hold the voltage [V], or what else drives the source, for that many steps."""
        if steps <= 0:
            return
        if self.composition.source.valve == "coil" and self._quickly(given, steps):
            return
        inputs = np.full((steps, *np.shape(given)), given, dtype=np.float64)
        self._run(step_inputs(inputs, self.composition.source), steps, self._row)

    def _quickly(self, given: float | Sequence[float], steps: int) -> bool:
        """A simulator's tick under a voltage: what is checked and cut for whole records would cost it more than the
        steps do. Whether it could be taken."""
        begin, end = self._all_act
        if not isinstance(given, float | int) or not isfinite(given) or begin > 0 or self.step_count + steps > end:
            return False
        if len(self._held) != steps:
            self._held = np.empty(steps)
        self._held.fill(given)
        self._state[AT.time] = self.time
        self._steps(self._held, steps, self._row, self._active)
        self.step_count += steps
        return True

    def run(self, inputs: Array, every: int = 1) -> Trajectory:
        """Apply one input a step; return the rows after every `every`-th step (the start is not among them).

        inputs: (steps,) voltages, or (steps,) or (steps, inputs) of what else drives the source, in SI units.
        """
        taken = step_inputs(inputs, self.composition.source)
        rows = np.empty((len(taken) // every, len(COLUMNS)))
        first = self.step_count
        self._run(taken, every, rows)
        if len(rows):
            self._row[0] = rows[-1]
        counts = first + every * np.arange(1, len(rows) + 1, dtype=np.float64)
        return Trajectory(counts * self.step_size, rows)

    def _run(self, inputs: Array, every: int, rows: Array) -> None:
        self._state[AT.time] = self.time
        for interval in intervals(self.step_count, len(inputs), every, self._timetable):
            if any(interval.beginning):
                self._start_memory(interval.beginning)
            self._steps(inputs[interval.steps], interval.every, rows[interval.rows], interval.acting)
        self.step_count += len(inputs)
        if self._hidden:
            rows[:, self._hidden] = np.nan

    def _steps(self, inputs: Array, every: int, rows: Array, active: tuple[bool, ...]) -> None:
        """Steps throughout which the same effects act."""
        given = self.composition.source.given
        if not given:
            self._kernel.advance(
                self._state, self._memory, self._history, self._vector, active, self._propagator, inputs,
                self.step_size, every, rows,
            )  # fmt: skip
            return
        # the step knows pressures: a force is one chamber's pressure over its area
        pressure_a = inputs[:, 0] / self._places["piston_area"] if given == "force" else inputs[:, 0].copy()
        pressure_b = 0.0 * pressure_a if given == "force" else inputs[:, 1].copy()
        self._kernel.advance_driven(
            self._state, self._memory, self._vector, active, pressure_a, pressure_b, self.step_size, every, rows
        )


def _kernel(source: Source) -> ModuleType:
    """The compiled step that takes this source's input."""
    return compiled_step() if source.valve == "coil" or source.given else compiled_given_step()


def starting_pressures(
    places: Mapping[str, float], position: float, composition: Composition = PAPER
) -> tuple[float, float]:
    """Pressures A and B [Pa] of a plant that starts at rest, of the parameters of the equations."""
    back = places["return_pressure"]
    total = 2.0 * back if composition.source.idle else places["supply_pressure"] + back
    if not composition.cylinder.balanced:
        return 0.5 * total, 0.5 * total
    area_a, area_b = places["piston_area"], places["piston_area_b"]
    pressure_a = (area_b * total + places["spring_stiffness"] * position) / (area_a + area_b)
    return pressure_a, total - pressure_a
