"""Plants with parameters of their own that advance together under one command, in lock-step."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from eha_core.effects import effects
from eha_core.plant.active_intervals import instants, pieces, spans
from eha_core.plant.composite import compiled_lanes, layout
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
from eha_core.plant.simulator import LONGEST_DELAY, Array, pack

CACHE_LINE = 64
"""Bytes."""


class LockStep:
    """Up to LANES parameter sets (every parameter of each), stepped together; each gives what `Plant` gives for it.

    It starts at rest: coil and spool settled under the voltage `before`, the effects' memory as that implies, pistons
    wherever `place` puts them. A lane more costs next to nothing until a register is full.

    Attributes:
        lanes: how many lanes are computed: as many as there are sets, rounded up to whole registers.
    """

    def __init__(self, sets: Sequence[Mapping[str, float]], step_size: float, before: float = 0.0) -> None:
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
        self._memory = list(self._memory_rows())
        self._rows = self._block.reshape(-1, LANES)[:, : self.lanes]
        self._fill(PARAMETERS, np.array([vector for vector, _, _ in packed]).T)
        self._fill(PROPAGATOR, np.array([valve for _, _, valve in packed]).T)
        current = np.array(
            [np.clip(before / v["coil_resistance"], -v["saturation_current"], v["saturation_current"]) for v in filled]
        )
        supply, back = (np.array([v[name] for v in filled]) for name in ("supply_pressure", "return_pressure"))
        self._fill(TIME, np.stack([0.0 * current, current, supply, back, current, current]))
        self._history = np.full(int(LONGEST_DELAY / step_size) + 3, before)
        self._history[-1] = 0
        self._kernel = compiled_lanes()

    def _memory_rows(self) -> Iterator[tuple[int, str, Array]]:
        """Which effect each memory slot is of, what it starts from, and its values in all lanes: a lane's slots of one
        effect lie together."""
        place = layout().memory
        for number, effect in enumerate(effects()):
            size = len(effect.memory) * LANES
            slots = self._block[place : place + size].reshape(LANES, -1)[: self.lanes]
            yield from ((number, *slot) for slot in zip(effect.memory, slots.T, strict=True))
            place += size

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
        for number, kind, slot in self._memory:
            chosen = slice(None) if beginning is None else beginning[:, number]
            slot[chosen] = 0.0 if kind == "zero" else self._rows[starts[kind] // LANES, chosen]

    def start_sensors(self, shown: Array) -> None:
        """Sensors that trail what they measure begin anew from what they showed: position, velocity, pressure A and
        pressure B."""
        for slot, state in zip(*trailing(), strict=True):
            self._memory[slot][2][:] = shown[state]

    def advance(self, first: int, inputs: Array, every: int, out: Array) -> None:
        """Take a step for each column of `inputs`, the first of them step `first` of the record.

        inputs: (1, steps) voltages, or (2, steps) chamber pressures that drive the pistons alone. out: (steps / every,
        columns, lanes), columns either four (what the sensors say) or, under a voltage, all of COLUMNS.
        """
        self._rows[TIME // LANES] = first * self.step_size
        starts, stops = self._spans[:, :, 0], self._spans[:, :, 1]
        for piece in pieces(first, inputs.shape[1], every, self._instants):
            at = first + piece.steps.start
            stretch = bisect_right(self._instants, at)
            if stretch != self._stretch:
                self._stretch = stretch
                beginning = (starts == at) & (starts > 0) & (starts < stops)
                if beginning.any():
                    self.start_memory(beginning)
                acts = ((starts <= at) & (at < stops)).T
                self._fill(layout().acts, acts.astype(np.float64))
                self._active = sum(1 << index for index in np.flatnonzero(acts.any(axis=1)).tolist())
            given, rows = inputs[:, piece.steps], out[piece.rows]
            if len(inputs) == 1:
                self._kernel.advance(
                    self._block, self.lanes, self._history, self._active, given[0], self.step_size, piece.every, rows
                )
            else:
                self._kernel.advance_driven(
                    self._block, self.lanes, self._active, given[0], given[1], self.step_size, piece.every, rows
                )


def _aligned(size: int) -> Array:
    """Zeros that begin where a cache line does: vectors that straddle two made a step up to twice as long."""
    zeros = np.zeros(size + CACHE_LINE // 8)
    skipped = -zeros.ctypes.data % CACHE_LINE // 8
    return zeros[skipped : skipped + size]
