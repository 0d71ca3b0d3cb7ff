"""The recording cut into windows, and the plant simulated through them.

A single simulation over the whole record drifts away if the model is wrong. So each window has its own initial state of
the piston (position, velocity, both pressures); coil, spool and the effects' own states run through, because they
hardly depend on the piston's position. The fit weights the continuity defects between windows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from eha_core.identification.numbers import Array, Integers
from eha_core.identification.per_recording import values_of
from eha_core.plant import PAPER, Composition
from eha_core.plant.active_intervals import BEGINS, FIRST, Timetable, Windows, spans, stretches
from eha_core.plant.composite import compiled_windows
from eha_core.plant.memory import start_memory, starting_memory, trailing
from eha_core.plant.one_by_one import side_by_side
from eha_core.plant.packing import pack
from eha_core.plant.ring import ring_size
from eha_core.plant.state import AT, COLUMNS, PISTON, SEEN, Places

STATE_SIZE = 4
"""Free at a window's start: position, velocity, pressure A, pressure B."""

SETTLING = 0.3
"""s at the record's start that are not compared: the initial states of coil, spool and effects are not known there."""

SLOPE_STEP = 5e-4
"""s; step size of the derivatives. They are accurate to a few per cent, which costs a fit no accuracy."""


@dataclass(frozen=True)
class Sampling:
    """The places of a channel's samples on the simulated rows: between `row` and the next, with weight `late` on the
    next. `noise` weights the residuals; `own_noise` is the channel's own estimate."""

    column: int
    row: Integers
    late: Array
    values: Array
    noise: float
    window: Integers
    own_noise: float


@dataclass(frozen=True)
class Shooting:
    """A recording ready to be simulated in windows.

    Attributes:
        step_size: [s]; `every` steps make a row.
        inputs: (1 or 2, steps) voltage, both pressures, force, or the source's other inputs, held over each step.
        edges: (windows + 1,) first step of each window, and the end.
        leakage: (windows,) recorded change of the internal leakage coefficient in each.
        samplings: one for each measured channel, sorted by time.
        initial_states: (windows, STATE_SIZE) from the smoothed measurement; pressures at half supply where not
        measured.
        first_windows: the first window of each recording; there all states begin again, and time too.
        restarts: windows without a continuity defect, because the inputs in the window before are not known.
        per_recording: the parameters that have a value in each recording.
        composition: the actuator's parts.
    """

    drive: str
    step_size: float
    every: int
    inputs: Array
    edges: Integers
    leakage: Array
    samplings: tuple[Sampling, ...]
    names: tuple[str, ...]
    initial_states: Array
    free_states: int
    first_windows: tuple[int, ...] = (0,)
    per_recording: tuple[str, ...] = ()
    composition: Composition = PAPER
    restarts: tuple[int, ...] = ()

    @property
    def windows(self) -> int:
        """The number of windows."""
        return len(self.edges) - 1

    @property
    def recordings(self) -> list[range]:
        """The windows of each recording."""
        return [range(first, last) for first, last in pairwise((*self.first_windows, self.windows))]

    @property
    def local_edges(self) -> Array:
        """(windows, 2) begin and end of each window [s], counted from its own recording's start."""
        starts = np.repeat(self.edges[list(self.first_windows)], [len(windows) for windows in self.recordings])
        return np.asarray(np.stack([self.edges[:-1] - starts, self.edges[1:] - starts], axis=1) * self.step_size)

    def times(self, sampling: Sampling) -> Array:
        """The times of a channel's samples [s], one recording after the other; a row's time is the end of its steps."""
        return np.asarray((sampling.row + 1 + sampling.late) * self.every * self.step_size)

    def simulate(self, values: Mapping[str, float], states: Array, full: bool = False) -> tuple[Array, Array]:
        """Simulate every window from its state (windows, 4); return measured rows and the windows' end states (windows,
        4).

        Rows: (steps / every, 4) position, velocity, pressure A, pressure B as measured; all columns if `full`.
        """
        if not self.composition.has_lockstep:
            together, ends_together = self._together([(values, states)], len(COLUMNS if full else SEEN))
            return together[:, :, 0], ends_together[:, :, 0]
        steps = int(self.edges[-1])
        rows = np.empty((steps // self.every, len(COLUMNS if full else SEEN)))
        ends = np.empty((self.windows, STATE_SIZE))
        for number, windows in enumerate(self.recordings, 1):
            self._simulate_one(self._values_of(values, number), states, windows, rows, ends)
        return rows, ends

    def _simulate_one(
        self, values: Mapping[str, float], states: Array, windows: range, rows: Array, ends: Array
    ) -> None:
        """Fill the rows and end states of one recording's windows."""
        changes = set(self.leakage[windows.start : windows.stop].tolist())
        packed = {
            change: pack({**values, "internal_leakage": values["internal_leakage"] + change}, self.step_size)
            for change in changes
        }
        acting = Timetable(spans(values, next(iter(packed.values()))[1], self.step_size))
        start, inputs, own = self._of(windows)
        first = inputs[0, 0]
        current = min(
            max(first / values["coil_resistance"], -values["saturation_current"]), values["saturation_current"]
        )
        state = np.zeros(len(Places._fields))
        state[[AT.target, AT.current, AT.spool_position]] = current
        state[AT.supply_pressure], state[AT.return_pressure] = values["supply_pressure"], values["return_pressure"]
        history = np.full(ring_size(self.step_size), first)
        history[-1] = 0
        memory = starting_memory(current, states[windows.start])
        kernel, slots = compiled_windows(), trailing().slots
        shown = np.ascontiguousarray(own.shown[:, trailing().states])
        starts = np.ascontiguousarray(states[windows.start : windows.stop])
        changed = own.edges[1:-1][np.diff(own.leakage) != 0.0].tolist()
        window = 0
        for stretch in stretches(own.edges, self.every, acting.instants, changed):
            at = int(stretch[0, FIRST])
            if stretch[0, BEGINS] >= 0:
                window = int(stretch[0, BEGINS])
            kernel.begin(stretch[0], self.step_size, starts, shown, slots, state, memory)
            if any(acting.beginning(at)):
                start_memory(memory, acting.beginning(at), state[AT.current], state[PISTON])
            vector, _, valve = packed[float(own.leakage[window])]
            if self.drive == "voltage":
                kernel.advance(
                    stretch, starts, shown, slots, ends[windows.start : windows.stop], state, memory, history, vector,
                    acting.acting(at), valve, inputs[0], self.step_size, rows[start // self.every :],
                )  # fmt: skip
            else:
                kernel.advance_driven(
                    stretch, starts, shown, slots, ends[windows.start : windows.stop], state, memory, vector,
                    acting.acting(at), inputs[0], inputs[1], self.step_size, rows[start // self.every :],
                )  # fmt: skip

    def _values_of(self, values: Mapping[str, float], number: int) -> Mapping[str, float]:
        """The parameters of one recording."""
        return values if len(self.first_windows) == 1 else values_of(values, number)

    def _of(self, windows: range) -> tuple[int, Array, Windows]:
        """A recording's first step, its inputs, and its windows counted from that step."""
        start, end = int(self.edges[windows.start]), int(self.edges[windows.stop])
        here = slice(windows.start, windows.stop)
        edges = self.edges[windows.start : windows.stop + 1] - start
        return start, self.inputs[:, start:end], Windows(edges, self.leakage[here], self.initial_states[here])

    def simulate_many(self, sets: Sequence[tuple[Mapping[str, float], Array]]) -> tuple[Array, Array]:
        """`simulate` for up to LANES pairs of values and states, in lock-step and to the same digits.

        Rows (steps / every, 4, lanes), the first lanes those of the sets, and the windows' end states (windows, 4,
        sets).
        """
        return self._together(sets, len(SEEN))

    def _together(self, sets: Sequence[tuple[Mapping[str, float], Array]], width: int) -> tuple[Array, Array]:
        rows: Array | None = None
        ends = np.empty((self.windows, STATE_SIZE, len(sets)))
        starts = np.stack([states for _, states in sets])
        for number, windows in enumerate(self.recordings, 1):
            start, inputs, own = self._of(windows)
            plants = [self._values_of(values, number) for values, _ in sets]
            lanes = side_by_side(plants, self.step_size, inputs[0, 0], self.composition)
            if rows is None:
                rows = np.empty((int(self.edges[-1]) // self.every, width, lanes.lanes))
            here = starts[:, windows.start : windows.stop]
            lanes.place(here[:, 0])
            lanes.start_memory()
            out = rows[start // self.every :]
            ends[windows.start : windows.stop] = lanes.advance_windows(own, here, inputs, self.every, out)
        assert rows is not None, "there is a recording"
        return rows, ends

    def sample(self, rows: Array) -> list[Array]:
        """The simulated value at each sample of each channel: (samples,), or (samples, sets) of rows of several."""
        late = [sampling.late.reshape(-1, *[1] * (rows.ndim - 2)) for sampling in self.samplings]
        return [
            (1.0 - share) * rows[sampling.row, sampling.column] + share * rows[sampling.row + 1, sampling.column]
            for sampling, share in zip(self.samplings, late, strict=True)
        ]
