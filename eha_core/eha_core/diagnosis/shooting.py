"""The recording cut into windows, and the plant simulated through them.

A single simulation over the whole record drifts away as soon as the model is wrong. So each window starts the piston's
state (position, velocity, both pressures) anew; coil, spool and the effects' own states run through, for they hardly
depend on where the piston is. What ties the windows together is the fit's concern.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.signal import savgol_filter

from eha_core.diagnosis.numbers import Array, Integers
from eha_core.diagnosis.observation import WITH_OIL, Measured, Observation
from eha_core.diagnosis.per_recording import values_of
from eha_core.effects import effects
from eha_core.plant import PAPER, Composition
from eha_core.plant.composite import compiled_step
from eha_core.plant.one_by_one import side_by_side
from eha_core.plant.simulator import LONGEST_DELAY, pack
from eha_core.plant.spells import span, spells
from eha_core.plant.state import AT, COLUMNS, PISTON, SEEN, Places

STATE_SIZE = 4
"""Free at a window's start: position, velocity, pressure A, pressure B."""

SETTLING = 0.3
"""s at the record's start that are not compared: coil, spool and the effects' own states start there unrecorded."""

TICK = 0.01
"""s; windows begin and end on this grid, which every step size used here divides."""

SLOPE_STEP = 5e-4
"""s; the step at which derivatives are taken. They are good to a few per cent, which costs a fit no accuracy."""


@dataclass(frozen=True)
class Sampling:
    """Where a channel's samples fall on the simulated rows: between `row` and the next, with weight `late` on the
    next."""

    column: int
    row: Integers
    late: Array
    values: Array
    noise: float
    window: Integers


@dataclass(frozen=True)
class Shooting:
    """A recording ready to be simulated in windows.

    Attributes:
        step_size: [s]; `every` steps make a row.
        inputs: (1 or 2, steps) voltage, both pressures, force, or what else drives the source, held over each step.
        edges: (windows + 1,) first step of each window, and the end.
        leakage: (windows,) what is added to the internal leakage coefficient in each, as the recording tells.
        samplings: one a measured channel, sorted by time.
        initial_states: (windows, STATE_SIZE) from the smoothed measurement; pressures at half supply where not
        measured.
        first_windows: the first window of each recording; there all that runs through begins anew, time too.
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

    @property
    def windows(self) -> int:
        """How many windows there are."""
        return len(self.edges) - 1

    @property
    def recordings(self) -> list[range]:
        """The windows of each recording."""
        return [range(first, last) for first, last in pairwise((*self.first_windows, self.windows))]

    @property
    def local_edges(self) -> Array:
        """(windows, 2) when each window begins and ends [s], counted from its own recording's start."""
        starts = np.repeat(self.edges[list(self.first_windows)], [len(one) for one in self.recordings])
        return np.asarray(np.stack([self.edges[:-1] - starts, self.edges[1:] - starts], axis=1) * self.step_size)

    def times(self, sampling: Sampling) -> Array:
        """When a channel's samples were taken [s], one recording after the other: a row stands at its steps' end."""
        return np.asarray((sampling.row + 1 + sampling.late) * self.every * self.step_size)

    def simulate(self, values: Mapping[str, float], states: Array, full: bool = False) -> tuple[Array, Array]:
        """Simulate every window from its state (windows, 4); return measured rows and the windows' end states (windows,
        4).

        Rows: (steps / every, 4) position, velocity, pressure A, pressure B as the sensors say; all columns if `full`.
        """
        if not self.composition.has_lockstep:
            together, ends_together = self._together([(values, states)], len(COLUMNS if full else SEEN))
            return together[:, :, 0], ends_together[:, :, 0]
        steps = int(self.edges[-1])
        rows = np.empty((steps // self.every, len(COLUMNS if full else SEEN)))
        ends = np.empty((self.windows, STATE_SIZE))
        for number, windows in enumerate(self.recordings, 1):
            self._simulate_one(values_of(values, number), states, windows, rows, ends)
        return rows, ends

    def _simulate_one(
        self, values: Mapping[str, float], states: Array, windows: range, rows: Array, ends: Array
    ) -> None:
        """Fill the rows and end states of one recording's windows."""
        step = compiled_step()
        changes = set(self.leakage[windows.start : windows.stop].tolist())
        packed = {
            change: pack({**values, "internal_leakage": values["internal_leakage"] + change}, self.step_size)
            for change in changes
        }
        acting, none = span(values, self.step_size), (False,) * len(effects())
        start = int(self.edges[windows.start])
        first = self.inputs[0, start]
        current = min(
            max(first / values["coil_resistance"], -values["saturation_current"]), values["saturation_current"]
        )
        state = np.zeros(len(Places._fields))
        state[[AT.target, AT.current, AT.spool_position]] = current
        state[AT.supply_pressure], state[AT.return_pressure] = values["supply_pressure"], values["return_pressure"]
        history = np.full(int(LONGEST_DELAY / self.step_size) + 3, first)
        history[-1] = 0
        memory, sensor_slots = self._memory(current, states[windows.start])
        for window in windows:
            begin, end = int(self.edges[window]), int(self.edges[window + 1])
            vector, active, valve = packed[float(self.leakage[window])]
            state[AT.time] = (begin - start) * self.step_size
            state[PISTON] = states[window]
            memory[sensor_slots] = self.initial_states[window, 0]
            inputs, out = self.inputs[:, begin:end], rows[begin // self.every : end // self.every]
            for spell in spells(begin - start, end - begin, self.every, acting):
                if spell.acting and begin - start + spell.steps.start == acting[0] > 0:
                    memory, _ = self._memory(state[AT.current], state[PISTON])
                effects_on, piece = active if spell.acting else none, inputs[:, spell.steps]
                if self.drive == "voltage":
                    step.advance(
                        state, memory, history, vector, effects_on, valve, piece[0], self.step_size, spell.every,
                        out[spell.rows],
                    )  # fmt: skip
                else:
                    step.advance_driven(
                        state, memory, vector, effects_on, piece[0], piece[1], self.step_size, spell.every,
                        out[spell.rows],
                    )  # fmt: skip
            ends[window] = state[PISTON]

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
            start = int(self.edges[windows.start])
            own = [values_of(values, number) for values, _ in sets]
            lanes = side_by_side(own, self.step_size, self.inputs[0, start], self.composition)
            if rows is None:
                rows = np.empty((int(self.edges[-1]) // self.every, width, lanes.lanes))
            lanes.place(starts[:, windows.start])
            lanes.start_memory()
            for window in windows:
                begin, end = int(self.edges[window]), int(self.edges[window + 1])
                lanes.add_leakage(float(self.leakage[window]))
                lanes.place(starts[:, window])
                lanes.start_sensors(float(self.initial_states[window, 0]))
                out = rows[begin // self.every : end // self.every]
                lanes.advance(begin - start, self.inputs[:, begin:end], self.every, out)
                ends[window] = lanes.states()[: len(sets)].T
        assert rows is not None, "there is a recording"
        return rows, ends

    def _memory(self, current: float, start: Array) -> tuple[Array, Integers]:
        """The effects' states where they begin to act, and which of them restart from the measured position in each
        window."""
        starts = {"zero": 0.0, "current": current, "position": start[0], "velocity": start[1]}
        memory: list[float] = []
        sensors: list[int] = []
        for effect in effects():
            for kind in effect.memory:
                if effect.site == "sensor" and kind == "position":
                    sensors.append(len(memory))
                memory.append(starts[kind])
        return np.array(memory or [0.0]), np.array(sensors, dtype=np.int64)

    def sample(self, rows: Array) -> list[Array]:
        """The simulated value at each sample of each channel: (samples,), or (samples, sets) of rows of several."""
        late = [one.late.reshape(-1, *[1] * (rows.ndim - 2)) for one in self.samplings]
        return [
            (1.0 - share) * rows[one.row, one.column] + share * rows[one.row + 1, one.column]
            for one, share in zip(self.samplings, late, strict=True)
        ]


def cut(
    observation: Observation,
    values: Mapping[str, float],
    step_size: float = 2e-4,
    window: float = 1.0,
    every: int | None = None,
) -> Shooting:
    """Lay the step grid over the recording, cut it into windows of about `window` seconds, and start each window's
    state.

    `values` gives the pressures at which unmeasured chambers start. `every` steps make a row: unless given, rows are
    one a sample where the samples allow it.
    """
    every = every or rows_every(observation, step_size)
    per_row = every * step_size
    count = max(1, round(observation.duration / window))
    ticks = int(observation.duration / TICK + 1e-6)
    changes = np.round(np.array([time for time, _ in observation.leakage]) / TICK).astype(np.int64)
    edges = _edges(ticks, count, changes) * round(TICK / step_size)
    leakage = np.concatenate([[0.0], [change for _, change in observation.leakage]])
    in_force = leakage[np.searchsorted(changes * round(TICK / step_size), edges[:-1], side="right")]
    step_times = np.arange(edges[-1]) * step_size
    hold = [
        values_[np.clip(np.searchsorted(time, step_times + 1e-9, side="right") - 1, 0, None)]
        if name == "voltage_command"
        else np.interp(step_times + 0.5 * step_size, time, values_)
        for name, (time, values_) in zip(observation.driving, observation.inputs, strict=True)
    ]
    if observation.drive == "force":
        # the step knows pressures: a force is one chamber's pressure over its area
        hold = [hold[0] / values["piston_area"], np.zeros_like(hold[0])]
    samplings = tuple(_place(channel, per_row, edges, every) for channel in observation.measured)
    return Shooting(
        observation.drive,
        step_size,
        every,
        np.ascontiguousarray(hold),
        edges,
        in_force,
        samplings,
        tuple(channel.name for channel in observation.measured),
        _initial_states(observation, np.asarray(edges * step_size), values),
        STATE_SIZE if observation.drive in WITH_OIL else 2,
        composition=observation.composition,
    )


def _edges(ticks: int, count: int, changes: Integers) -> Integers:
    """About `count` windows of one length, and a new window where something is changed on purpose."""
    even = np.round(np.linspace(0, ticks, count + 1)).astype(np.int64)
    shortest = 0.3 * ticks / count
    inner = [edge for edge in even[1:-1] if np.all(np.abs(changes - edge) > shortest)]
    return np.unique(np.concatenate([[0, ticks], inner, changes[(changes > 0) & (changes < ticks)]]).astype(np.int64))


def coarser(fine: Shooting, step_size: float) -> Shooting:
    """The same windows and samples on a coarser step, for derivatives."""
    factor = step_size / fine.step_size
    if factor <= 1.0:
        return fine
    edges = np.round(fine.edges / factor).astype(np.int64)
    every = max(1, int(fine.every / factor + 1e-9))
    if edges[-1] % every or np.any(edges % every):
        every = 1
    # a held voltage keeps its mean over the coarser step
    cells = np.minimum((np.arange(fine.edges[-1]) / factor).astype(np.int64), edges[-1] - 1)
    counts = np.bincount(cells, minlength=edges[-1])
    inputs = np.stack([np.bincount(cells, weights=one, minlength=edges[-1]) / counts for one in fine.inputs])
    samplings = []
    for one in fine.samplings:
        place = (one.row + 1 + one.late) * (fine.every / (factor * every)) - 1.0
        first, last = edges[one.window] // every, edges[one.window + 1] // every - 1
        # a sample beside a window's edge is reached by extrapolation from inside the window
        row = np.clip(np.floor(place + 1e-6).astype(np.int64), first, np.maximum(last - 1, first))
        samplings.append(replace(one, row=row, late=place - row))
    return replace(
        fine,
        step_size=step_size,
        every=every,
        edges=edges,
        inputs=np.ascontiguousarray(inputs),
        samplings=tuple(samplings),
    )


def rows_every(observation: Observation, step_size: float) -> int:
    """A row a sample for evenly sampled channels; otherwise rows close enough to interpolate the oil's fast motion."""
    for channel in observation.measured:
        gaps = np.diff(channel.time)
        regular = np.median(gaps)
        phase = channel.time / regular
        if np.max(np.abs(phase - np.round(phase))) * regular > 0.02 * step_size:
            return 1
        if abs(regular / step_size - round(regular / step_size)) > 1e-6:
            return 1
    spacings = [round(float(np.median(np.diff(one.time))) / step_size) for one in observation.measured]
    return int(np.gcd.reduce([round(TICK / step_size), *spacings]))


def _place(channel: Measured, per_row: float, edges: Integers, every: int) -> Sampling:
    """Rows stand at the ends of their steps: row r at (r + 1) per_row. A sample never straddles two windows."""
    place = channel.time / per_row - 1.0
    place = np.where(np.abs(place - np.round(place)) < 1e-6, np.round(place), place)
    row = np.floor(place).astype(np.int64)
    last = edges[-1] // every - 1
    window = np.searchsorted(edges // every, row, side="right") - 1
    end = edges[np.clip(window + 1, 0, len(edges) - 1)] // every - 1
    usable = (channel.time >= SETTLING) & (row >= 0) & (row <= last) & ((row < end) | (place == row))
    row, place, window = row[usable], place[usable], window[usable]
    late = place - row
    row = np.minimum(row, last - 1) if len(row) else row
    late = np.where(place > row, place - row, late)
    return Sampling(channel.column, row, late, channel.values[usable], channel.noise, window)


def _initial_states(observation: Observation, times: Array, values: Mapping[str, float]) -> Array:
    starts = times[:-1]
    half = 0.5 * (values["supply_pressure"] + values["return_pressure"])
    states = np.empty((len(starts), STATE_SIZE))
    position = observation.channel("position")
    assert position is not None
    states[:, 0] = np.interp(starts, position.time, smooth(position, 0))
    states[:, 1] = np.interp(starts, position.time, smooth(position, 1))
    for column, name in ((2, "pressure_a"), (3, "pressure_b")):
        channel = observation.channel(name)
        states[:, column] = half if channel is None else np.interp(starts, channel.time, smooth(channel, 0))
    return states


def smooth(channel: Measured, derivative: int, span: float = 0.02) -> Array:
    """A local cubic through the samples within `span` seconds, or its derivative, at each sample."""
    spacing = float(np.median(np.diff(channel.time)))
    length = max(5, 2 * int(0.5 * span / spacing) + 1)
    length = min(length, len(channel.values) - 1 + len(channel.values) % 2)
    return np.asarray(savgol_filter(channel.values, length, 3, deriv=derivative, delta=spacing))


def held_out(windows: int) -> Sequence[int]:
    """Every third window, the middle one of each three: what a hypothesis is judged on and not fitted to."""
    return range(1, windows, 3)
