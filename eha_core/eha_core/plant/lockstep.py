"""Plants with parameters of their own that advance together under one command, in lock-step."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects
from eha_core.plant.active_intervals import FIRST, Integers, Windows, instants, pieces, spans, stretches
from eha_core.plant.composite import compiled_lanes, compiled_windows, layout
from eha_core.plant.lane_rows import (
    CURRENT,
    LANES,
    PARAMETERS,
    POSITION,
    PRESSURE_A,
    PRESSURE_B,
    PROPAGATOR,
    REGISTER,
    STATED_LEAKAGE,
    TIME,
    VELOCITY,
)
from eha_core.plant.memory import trailing
from eha_core.plant.packing import pack
from eha_core.plant.ring import ring_size
from eha_core.plant.simulator import Array

CACHE_LINE = 64
"""Bytes."""


class LockStep:
    """Up to LANES parameter sets (every parameter of each), stepped together; each gives what `Plant` gives for it.

    It starts at rest: coil and spool settled under the voltage `before`, the effects' memory as that implies, pistons
    wherever `place` puts them. A lane more costs next to nothing until a register is full. With `own_commands` each has
    a voltage of its own, which `advance_each` takes.

    Attributes:
        lanes: how many lanes are computed: as many as there are sets, rounded up to whole registers.
    """

    def __init__(
        self,
        sets: Sequence[Mapping[str, float]],
        step_size: float,
        before: float = 0.0,
        own_commands: bool = False,
    ) -> None:
        assert 0 < len(sets) <= LANES, "a block takes no more"
        self.lanes = -(-len(sets) // REGISTER) * REGISTER
        self.step_size = step_size
        filled = [*sets, *[sets[-1]] * (self.lanes - len(sets))]
        packed = [pack(values, step_size) for values in filled]
        pairs = zip(filled, packed, strict=True)
        self._spans = np.array([spans(values, active, step_size) for values, (_, active, _) in pairs])
        self._instants = sorted(instants(map(tuple, self._spans.reshape(-1, 2).tolist())))
        self._stretch = -1  # between which instants the effects' rows stand, once they do
        self._active = 0
        self._leakage = np.array([values["internal_leakage"] for values in filled])
        self._block = _aligned(layout().end)
        self._rows = self._block.reshape(-1, LANES)[:, : self.lanes]
        self._fill(PARAMETERS, np.array([vector for vector, _, _ in packed]).T)
        self._fill(PROPAGATOR, np.array([valve for _, _, valve in packed]).T)
        current = np.array(
            [np.clip(before / v["coil_resistance"], -v["saturation_current"], v["saturation_current"]) for v in filled]
        )
        supply, back = (np.array([v[name] for v in filled]) for name in ("supply_pressure", "return_pressure"))
        self._fill(TIME, np.stack([0.0 * current, current, supply, back, current, current]))
        self._history = np.full(ring_size(step_size) * (self.lanes if own_commands else 1), before)
        self._history[-1] = 0
        self._kernel = compiled_lanes()

    def _fill(self, place: int, rows: Array) -> None:
        self._rows[place // LANES : place // LANES + len(rows)] = rows

    def place(self, states: Array) -> None:
        """Put the pistons into states (sets, 4): position, velocity, pressure A, pressure B. All else goes on."""
        spare = self.lanes - len(states)
        self._fill(POSITION, np.concatenate([states, np.repeat(states[-1:], spare, axis=0)]).T)

    def states(self) -> Array:
        """Position, velocity, pressure A and pressure B (lanes, 4) as they stand."""
        return self._rows[POSITION // LANES : PRESSURE_B // LANES + 1].T.copy()

    def add_leakage(self, change: float) -> None:
        """From now on the internal leakage coefficient is `change` above that of the parameters."""
        self._fill(STATED_LEAKAGE, self._leakage[None] + change)

    def start_memory(self, beginning: NDArray[np.bool_] | None = None) -> None:
        """The effects' own states as they are where the effects begin to act: all of them, or these (lanes,
        effects)."""
        starts = {"current": CURRENT, "position": POSITION, "velocity": VELOCITY, "pressure_a": PRESSURE_A,
                  "pressure_b": PRESSURE_B}  # fmt: skip
        for (number, kind), places in zip(_memory(), memory_places()[:, : self.lanes], strict=True):
            chosen = slice(None) if beginning is None else beginning[:, number]
            self._block[places[chosen]] = 0.0 if kind == "zero" else self._rows[starts[kind] // LANES, chosen]

    def start_sensors(self, shown: Array) -> None:
        """Sensors that trail what they measure begin anew from what they showed: position, velocity, pressure A and
        pressure B."""
        self._block[memory_places()[trailing().slots, : self.lanes]] = shown[trailing().states, None]

    def advance(self, first: int, inputs: Array, every: int, out: Array) -> None:
        """Take a step for each column of `inputs`, the first of them step `first` of the record.

        inputs: (1, steps) voltages, or (2, steps) chamber pressures that drive the pistons alone. out: (steps / every,
        columns, lanes), columns either four (what the sensors say) or, under a voltage, all of COLUMNS.
        """
        self._rows[TIME // LANES] = first * self.step_size
        for piece in pieces(first, inputs.shape[1], every, self._instants):
            self._act(first + piece.steps.start)
            given, rows = inputs[:, piece.steps], out[piece.rows]
            if len(inputs) == 1:
                self._kernel.advance(
                    self._block, self.lanes, self._history, self._active, given[0], self.step_size, piece.every, rows
                )
            else:
                self._kernel.advance_driven(
                    self._block, self.lanes, self._active, given[0], given[1], self.step_size, piece.every, rows
                )

    def advance_each(self, first: int, voltages: Array, steps: int, out: Array) -> None:
        """Hold a voltage of its own (sets,) [V] in each lane for that many steps, the first of them step `first` of the
        record. out: (1, columns, lanes), the last step's row, columns as in `advance`."""
        spare = np.minimum(np.arange(self.lanes), len(voltages) - 1)
        held = np.tile(voltages[spare], steps)
        self._rows[TIME // LANES] = first * self.step_size
        for piece in pieces(first, steps, steps, self._instants):
            self._act(first + piece.steps.start)
            given = held[piece.steps.start * self.lanes : piece.steps.stop * self.lanes]
            self._kernel.advance(
                self._block, self.lanes, self._history, self._active, given, self.step_size, piece.every,
                out[piece.rows],
            )  # fmt: skip

    def advance_windows(self, windows: Windows, starts: Array, inputs: Array, every: int, out: Array) -> Array:
        """Take a step for each column of `inputs` through the windows of a record, in each of which the pistons begin
        in the states `starts` (sets, windows, 4).

        inputs, out: as in `advance`. Returns the pistons' states at the windows' ends, (windows, 4, sets).
        """
        slots = memory_places()[trailing().slots]
        spare = np.minimum(np.arange(self.lanes), len(starts) - 1)
        starting = np.ascontiguousarray(np.moveaxis(starts[spare], 0, 2))
        shown = np.ascontiguousarray(windows.shown[:, trailing().states])
        leaking = self._leakage + windows.leakage[:, None]
        ends = np.empty_like(starting)
        kernel = compiled_windows()
        for stretch in stretches(windows.edges, every, self._instants):
            kernel.begin_lanes(stretch[0], self.step_size, starting, shown, leaking, slots, self._block, self.lanes)
            self._act(int(stretch[0, FIRST]))
            if len(inputs) == 1:
                kernel.advance_lanes(
                    stretch, starting, shown, leaking, slots, ends, self._block, self.lanes, self._history,
                    self._active, inputs[0], self.step_size, out,
                )  # fmt: skip
            else:
                kernel.advance_lanes_driven(
                    stretch, starting, shown, leaking, slots, ends, self._block, self.lanes, self._active, inputs[0],
                    inputs[1], self.step_size, out,
                )  # fmt: skip
        return ends[:, :, : len(starts)]

    def _act(self, step: int) -> None:
        """Let those effects act that do from this step of the record on."""
        stretch = bisect_right(self._instants, step)
        if stretch == self._stretch:
            return
        self._stretch = stretch
        starts, stops = self._spans[:, :, 0], self._spans[:, :, 1]
        beginning = (starts == step) & (starts > 0) & (starts < stops)
        if beginning.any():
            self.start_memory(beginning)
        acts = ((starts <= step) & (step < stops)).T
        self._fill(layout().acts, acts.astype(np.float64))
        self._active = sum(1 << index for index in np.flatnonzero(acts.any(axis=1)).tolist())


@cache
def _memory() -> list[tuple[int, str]]:
    """Of each memory slot, which effect it is of and what it starts from."""
    return [(number, kind) for number, effect in enumerate(effects()) for kind in effect.memory]


@cache
def memory_places() -> Integers:
    """Where each memory slot stands in the block, in each lane (slots, LANES)."""
    return np.arange(layout().memory, layout().acts, dtype=np.int64).reshape(-1, LANES)


def _aligned(size: int) -> Array:
    """Zeros that begin where a cache line does: vectors that straddle two made a step up to twice as long."""
    zeros = np.zeros(size + CACHE_LINE // 8)
    skipped = -zeros.ctypes.data % CACHE_LINE // 8
    return zeros[skipped : skipped + size]
