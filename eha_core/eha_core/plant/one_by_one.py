"""Plants of sources that the lock-step does not know, advanced one after another behind the lock-step's interface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects
from eha_core.plant.active_intervals import Windows, instants, pieces, spans
from eha_core.plant.composite import compiled_given_step
from eha_core.plant.composition import PAPER, Composition
from eha_core.plant.lockstep import LockStep
from eha_core.plant.memory import trailing
from eha_core.plant.packing import pack
from eha_core.plant.simulator import Array, step_inputs
from eha_core.plant.state import AT, PISTON, Places


class OneByOne:
    """`LockStep` for a composition without one: the same methods, as many lanes as there are parameter sets.

    `before` is what the source was given until then: a current or a spool position at which the valve has settled.
    """

    def __init__(
        self, sets: Sequence[Mapping[str, float]], step_size: float, before: float, composition: Composition
    ) -> None:
        self.lanes = len(sets)
        self.step_size = step_size
        self._composition = composition
        self._sets = list(sets)
        self._kernel = compiled_given_step()
        self._kinds = [(number, kind) for number, effect in enumerate(effects()) for kind in effect.memory]
        self._states = np.zeros((len(sets), len(Places._fields)))
        self._memories = np.zeros((len(sets), max(1, len(self._kinds))))
        self._history = np.zeros(2)  # of voltages, of which there are none
        settled = before if composition.source.valve else 0.0
        for state, values in zip(self._states, sets, strict=True):
            state[[AT.target, AT.current, AT.spool_position]] = settled
            rests = "return_pressure" if composition.source.line else "supply_pressure"
            state[AT.supply_pressure], state[AT.return_pressure] = values[rests], values["return_pressure"]
        self._change = np.nan
        self.add_leakage(0.0)
        pairs = zip(sets, self._packed, strict=True)
        self._spans = np.array([spans(values, active, step_size) for values, (_, active, _) in pairs])

    def place(self, states: Array) -> None:
        """As `LockStep.place`."""
        self._states[:, PISTON] = states

    def states(self) -> Array:
        """As `LockStep.states`."""
        return self._states[:, PISTON].copy()

    def add_leakage(self, change: float) -> None:
        """As `LockStep.add_leakage`."""
        if change == self._change:
            return
        self._change = change
        leaking = [{**values, "internal_leakage": values["internal_leakage"] + change} for values in self._sets]
        self._packed = [pack(values, self.step_size, self._composition) for values in leaking]

    def start_memory(self, beginning: NDArray[np.bool_] | None = None) -> None:
        """As `LockStep.start_memory`."""
        for lane in range(self.lanes):
            for slot, (number, kind) in enumerate(self._kinds):
                if beginning is None or beginning[lane, number]:
                    self._memories[lane, slot] = 0.0 if kind == "zero" else self._states[lane, getattr(AT, kind)]

    def start_sensors(self, shown: Array) -> None:
        """As `LockStep.start_sensors`."""
        self._memories[:, trailing().slots] = shown[trailing().states]

    def advance(self, first: int, inputs: Array, every: int, out: Array) -> None:
        """As `LockStep.advance`, inputs (1 or 2, steps) being those of the source."""
        given = step_inputs(inputs.T, self._composition.source)
        self._states[:, AT.time] = first * self.step_size
        starts, stops = self._spans[:, :, 0], self._spans[:, :, 1]
        for piece in pieces(first, len(given), every, instants(map(tuple, self._spans.reshape(-1, 2).tolist()))):
            at = first + piece.steps.start
            beginning = (starts == at) & (starts > 0) & (starts < stops)
            if beginning.any():
                self.start_memory(beginning)
            acting = (starts <= at) & (at < stops)
            for lane, (vector, _, valve) in enumerate(self._packed):
                rows = np.empty(out[piece.rows].shape[:2])
                self._kernel.advance(
                    self._states[lane], self._memories[lane], self._history, vector,
                    tuple(acting[lane].tolist()), valve, given[piece.steps], self.step_size,
                    piece.every, rows,
                )  # fmt: skip
                out[piece.rows, :, lane] = rows

    def advance_windows(self, windows: Windows, starts: Array, inputs: Array, every: int, out: Array) -> Array:
        """As `LockStep.advance_windows`."""
        ends = np.empty((len(windows.leakage), starts.shape[2], len(starts)))
        for window, (begin, end) in enumerate(pairwise(windows.edges.tolist())):
            self.add_leakage(float(windows.leakage[window]))
            self.place(starts[:, window])
            self.start_sensors(windows.shown[window])
            self.advance(begin, inputs[:, begin:end], every, out[begin // every : end // every])
            ends[window] = self.states().T
        return ends


def side_by_side(
    sets: Sequence[Mapping[str, float]], step_size: float, before: float = 0.0, composition: Composition = PAPER
) -> LockStep | OneByOne:
    """Plants that advance together: in lock-step where their composition has one, else one after another."""
    if composition.has_lockstep:
        return LockStep(sets, step_size, before)
    return OneByOne(sets, step_size, before, composition)
