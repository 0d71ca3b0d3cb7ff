"""Recordings cut into windows: the step grid, where the samples fall on it, and each window's measured start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import savgol_coeffs, savgol_filter

from eha_core.identification.numbers import Array, Integers
from eha_core.identification.observation import TICK, WITH_OIL, Measured, Observation
from eha_core.identification.shooting import SETTLING, STATE_SIZE, Sampling, Shooting

SPAN = 0.02
"""s; through the samples of so long a time channels are smoothed."""

BENT = 4.0
"""Standard deviations by which a cubic through more samples may differ from one through fewer: beyond, the channel
bends. Noise alone does so once in 16,000 samples."""


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
    begins, ends = _unknown_spans(observation)
    edges = _edges(ticks, count, np.concatenate([changes, begins, ends]))
    inside = np.any((edges[:, None] > begins) & (edges[:, None] < ends), axis=1)
    edges = edges[~inside] * round(TICK / step_size)
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
        restarts=_restarts(edges, np.concatenate([begins, ends]) * round(TICK / step_size)),
    )


def _unknown_spans(observation: Observation) -> tuple[Integers, Integers]:
    """The ticks at which spans begin and end in which it is not known what drove the plant: each is a window of its
    own, and the piston's state after it is fitted anew."""
    spans = np.round(np.array(observation.undriven).reshape(-1, 2) / TICK).astype(np.int64)
    return spans[:, 0], spans[:, 1]


def _restarts(edges: Integers, at: Integers) -> tuple[int, ...]:
    """The windows that begin where it is no longer, or at last, known what drives the plant."""
    return tuple(int(window) for window in np.flatnonzero(np.isin(edges[:-1], at)) if window)


def _edges(ticks: int, count: int, changes: Integers) -> Integers:
    """About `count` windows of one length, and a new window where something is changed on purpose or not known."""
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
    inputs = np.stack([np.bincount(cells, weights=values, minlength=edges[-1]) / counts for values in fine.inputs])
    samplings = []
    for sampling in fine.samplings:
        place = (sampling.row + 1 + sampling.late) * (fine.every / (factor * every)) - 1.0
        first, last = edges[sampling.window] // every, edges[sampling.window + 1] // every - 1
        # a sample beside a window's edge is reached by extrapolation from inside the window
        row = np.clip(np.floor(place + 1e-6).astype(np.int64), first, np.maximum(last - 1, first))
        samplings.append(replace(sampling, row=row, late=place - row))
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
    spacings = [round(float(np.median(np.diff(channel.time))) / step_size) for channel in observation.measured]
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
    return Sampling(channel.column, row, late, channel.values[usable], channel.noise, window, channel.noise)


def _initial_states(observation: Observation, times: Array, values: Mapping[str, float]) -> Array:
    starts = times[:-1]
    half = 0.5 * (values["supply_pressure"] + values["return_pressure"])
    states = np.empty((len(starts), STATE_SIZE))
    position = observation.channel("position")
    assert position is not None
    states[:, 0] = np.interp(starts, position.time, follow(position))
    states[:, 1] = np.interp(starts, position.time, smooth(position, 1))
    for column, name in ((2, "pressure_a"), (3, "pressure_b")):
        channel = observation.channel(name)
        states[:, column] = half if channel is None else np.interp(starts, channel.time, follow(channel))
    return states


def smooth(channel: Measured, derivative: int, span: float = SPAN) -> Array:
    """A local cubic through the samples within `span` seconds, or its derivative, at each sample."""
    length, spacing = _length(channel, span)
    return np.asarray(savgol_filter(channel.values, length, 3, deriv=derivative, delta=spacing))


def _length(channel: Measured, span: float) -> tuple[int, float]:
    """The samples within `span` seconds, an odd number, five at least, and no more than there are; and the time [s]
    from one to the next."""
    spacing = float(np.median(np.diff(channel.time)))
    length = max(5, 2 * int(0.5 * span / spacing) + 1)
    return min(length, len(channel.values) - 1 + len(channel.values) % 2), spacing


def follow(channel: Measured) -> Array:
    """A channel without most of its noise, at each sample: as `smooth`, but through fewer samples where that differs
    from a cubic through fewer by more than noise makes it (O. V. Lepskii, Theory Probab. Appl. 35, 1990).

    Windows start here, and sensors that lag with them: where pressures bend, a cubic through 20 ms may be wrong by
    several times the noise, which is then seen until the sensor has forgotten it.
    """
    longest, _ = _length(channel, SPAN)
    closer, agrees = [(channel.values, 1.0)], np.ones(len(channel.values), dtype=bool)
    followed = channel.values
    for length in sorted({length for length in (longest // 4 | 1, longest // 2 | 1, longest) if length >= 5}):
        cubic = np.asarray(savgol_filter(channel.values, length, 3))
        # the weight of the middle sample is the share of the noise's variance that a least-squares fit leaves there,
        # and an estimate from fewer of the same samples differs from it by as much as its own variance is larger
        share = float(savgol_coeffs(length, 3)[length // 2])
        for shorter, of_shorter in closer:
            agrees &= np.abs(cubic - shorter) < BENT * channel.noise * np.sqrt(of_shorter - share)
        followed = np.where(agrees, cubic, followed)
        closer.append((cubic, share))
    return followed


def held_out(windows: int) -> Sequence[int]:
    """Every third window, the middle one of each three: what a hypothesis is judged on and not fitted to."""
    return range(1, windows, 3)
