"""The actuator as an object: parameters in force, state, and time in exact steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import expm1, isfinite
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from eha_core.effects import effects
from eha_core.errors import ParameterError
from eha_core.parameters import changed, nominal_values
from eha_core.plant.composite import compiled_step
from eha_core.plant.spells import span, spells
from eha_core.plant.state import AT, COLUMNS, PISTON, Places, Row

Array = NDArray[np.float64]


LONGEST_DELAY = 0.25
"""s; how far back the plant remembers its command. The command delay's upper bound."""


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


@lru_cache(maxsize=4096)
def propagator(
    resistance: float, inductance: float, damping_ratio: float, frequency: float, step_size: float
) -> tuple[float, ...]:
    """Exact solution of equations (1) and (2) over one step, as `eha_core.plant.step.advance` takes it.

    Under a held voltage the current moves from one target to the next as (1 - exp(-a t)) / (1 - exp(-a h)) with
    a = R_c / L_c; the spool's response to a constant and to exp(-a t) comes from one matrix exponential.
    """
    rate = resistance / inductance
    square = frequency * frequency
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-square, -2.0 * damping_ratio * frequency, square, square]
    system[3, 3] = -rate
    response = expm(system * step_size)
    decayed = -expm1(-rate * step_size)
    constant, fading = response[:2, 2], response[:2, 3]
    from_old = (fading - (1.0 - decayed) * constant) / decayed
    from_new = (constant - fading) / decayed
    rows = [[response[i, 0], response[i, 1], from_old[i], from_new[i]] for i in range(2)]
    return (1.0 - decayed, 1.0 / resistance, *map(float, rows[0]), *map(float, rows[1]))


Packed = tuple[tuple[float, ...], tuple[bool, ...], tuple[float, ...]]


def pack(values: Mapping[str, float], step_size: float) -> Packed:
    """Parameters (catalogue order), which effects act (catalogue order), and the valve's propagator.

    Tuples, for the compiled step holds them in registers and does no reference counting on them.
    """
    vector = tuple(values.values())
    active = tuple(effect.is_active(values) for effect in effects())
    valve = propagator(
        values["coil_resistance"], values["coil_inductance"], values["valve_damping_ratio"],
        values["valve_natural_frequency"], step_size,
    )
    return vector, active, valve


def check_step_size(step_size: float) -> None:
    """Raise ParameterError for a step [s] that the plant is not made for."""
    if not (isfinite(step_size) and 1e-6 <= step_size <= 1e-3):
        raise ParameterError(f"step_size = {step_size:g} s is out of range; give 1e-6 to 1e-3 s")


def check_voltages(voltages: Array) -> None:
    """Raise ParameterError for a command [V] that is not finite."""
    if not np.all(np.isfinite(voltages)):
        raise ParameterError("the voltage command is not finite; give volts")


class Plant:
    """The electro-hydraulic servo actuator of equations (1) to (10) with the catalogue's effects.

    Raises ParameterError for parameters that make no plant, a step that is not 1e-6 to 1e-3 s, or a start outside the
    stroke. The state stays finite and inside the stroke, and absolute pressures at or above zero, for any finite
    voltage.
    """

    def __init__(
        self, parameters: Mapping[str, float] | None = None, step_size: float = 1e-4, initial_position: float = 0.0
    ) -> None:
        check_step_size(step_size)
        self.step_size = step_size
        self._advance = compiled_step().advance
        self._values = changed(nominal_values(), parameters or {})
        self._vector, self._active, self._propagator = pack(self._values, step_size)
        self._none = (False,) * len(self._active)
        self._span = span(self._values, step_size)
        self._row = np.zeros((1, len(COLUMNS)))
        self._held = np.empty(0)  # the voltages of a tick, kept from one to the next
        self.reset(initial_position)

    @property
    def parameters(self) -> Mapping[str, float]:
        """Every parameter in force, by its full name."""
        return MappingProxyType(self._values)

    def set_parameters(self, changes: Mapping[str, float]) -> None:
        """Apply `changes` from the next step on, all of them or, raising ParameterError, none."""
        values = changed(self._values, changes)
        before = self._active
        self._values = values
        self._vector, self._active, self._propagator = pack(values, self.step_size)
        self._span = span(values, self.step_size)
        self._start_memory([now and not then for now, then in zip(self._active, before, strict=True)])
        stroke = values["actuator_displacement"]
        self._state[AT.position] = min(max(self._state[AT.position], -stroke), stroke)

    def reset(self, initial_position: float | None = None) -> None:
        """Back to rest at the initial position, both chambers midway between supply and return, and to time zero."""
        if initial_position is not None:
            stroke = self._values["actuator_displacement"]
            if not abs(initial_position) <= stroke:
                raise ParameterError(
                    f"initial_position = {initial_position:g} m is outside the stroke of +-{stroke:g} m"
                )
            self._initial_position = initial_position
        supply, back = self._values["supply_pressure"], self._values["return_pressure"]
        half = 0.5 * (supply + back)
        self._state = np.zeros(len(Places._fields))
        self._state[AT.supply_pressure], self._state[AT.return_pressure] = supply, back
        self._state[PISTON] = self._initial_position, 0.0, half, half
        self._history = np.zeros(int(LONGEST_DELAY / self.step_size) + 3)
        self._memory = np.zeros(max(1, sum(len(effect.memory) for effect in effects())))
        self._start_memory([True] * len(effects()))
        self.step_count = 0
        self._row[0] = Row(*[0.0] * len(COLUMNS))._replace(
            position=self._initial_position, pressure_a=half, pressure_b=half, supply_pressure=supply,
            return_pressure=back, internal_leakage=self._values["internal_leakage"],
            measured_position=self._initial_position, measured_pressure_a=half, measured_pressure_b=half,
        )  # fmt: skip

    def place(self, position: float, velocity: float, pressure_a: float, pressure_b: float) -> None:
        """Put piston and chambers into a measured state [SI]; time, valve, and the effects' own states go on."""
        stroke = self._values["actuator_displacement"]
        self._state[PISTON] = min(max(position, -stroke), stroke), velocity, pressure_a, pressure_b

    def _start_memory(self, chosen: Sequence[bool]) -> None:
        starts = {"zero": 0.0} | {name: self._state[getattr(AT, name)] for name in ("current", "position", "velocity")}
        slot = 0
        for effect, take in zip(effects(), chosen, strict=True):
            for start in effect.memory:
                if take:
                    self._memory[slot] = starts[start]
                slot += 1

    @property
    def time(self) -> float:
        """Seconds since the last reset: the step count times the step, without accumulated rounding."""
        return self.step_count * self.step_size

    @property
    def state(self) -> Row:
        """The row after the last step."""
        return Row(*self._row[0].tolist())

    def advance(self, voltage: float, steps: int) -> None:
        """Hold `voltage` [V] for that many steps.

        This is a simulator's tick: what is checked and cut for whole records would cost it more than the steps do.
        """
        if steps <= 0:
            return
        if len(self._held) != steps:
            self._held = np.empty(steps)
        self._held.fill(voltage)
        begin, end = self._span
        if begin > 0 or self.step_count + steps > end or not isfinite(voltage):
            self._run(self._held, steps, self._row)
            return
        self._state[AT.time] = self.time
        self._take(self._active, self._held, steps, self._row)
        self.step_count += steps

    def run(self, voltages: Array, every: int = 1) -> Trajectory:
        """Apply one voltage a step; return the rows after every `every`-th step (the start is not among them)."""
        voltages = np.ascontiguousarray(voltages, dtype=np.float64)
        rows = np.empty((len(voltages) // every, len(COLUMNS)))
        first = self.step_count
        self._run(voltages, every, rows)
        if len(rows):
            self._row[0] = rows[-1]
        counts = first + every * np.arange(1, len(rows) + 1, dtype=np.float64)
        return Trajectory(counts * self.step_size, rows)

    def _run(self, voltages: Array, every: int, rows: Array) -> None:
        check_voltages(voltages)
        self._state[AT.time] = self.time
        for spell in spells(self.step_count, len(voltages), every, self._span):
            if spell.acting and self.step_count + spell.steps.start == self._span[0] > 0:
                self._start_memory([True] * len(effects()))
            active = self._active if spell.acting else self._none
            self._take(active, voltages[spell.steps], spell.every, rows[spell.rows])
        self.step_count += len(voltages)

    def _take(self, active: tuple[bool, ...], voltages: Array, every: int, rows: Array) -> None:
        self._advance(
            self._state, self._memory, self._history, self._vector, active, self._propagator, voltages,
            self.step_size, every, rows,
        )  # fmt: skip
