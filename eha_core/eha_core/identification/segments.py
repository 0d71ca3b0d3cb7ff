"""Recordings cut into windows: the step grid, the samples' places on it, and each window's measured initial state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import savgol_coeffs, savgol_filter

from eha_core.identification.numbers import Array, Integers
from eha_core.identification.observation import TICK, WITH_OIL, Measured, Observation
from eha_core.identification.shooting import SETTLING, STATE_SIZE, Sampling, Shooting

SPAN = 0.02
"""s; window of the smoothing cubics."""

GAP = 2.5
"""Sampling periods between samples, more than which are a gap if they are a quarter of SPAN, too: single samples that
are lost hardly bend a cubic (assumed)."""

BENT = 4.0
"""Standard deviations by which a cubic through more samples may differ from one through fewer before the channel counts
as bending. Noise alone does so once in 16,000 samples."""


def cut(
    observation: Observation,
    values: Mapping[str, float],
    step_size: float = 2e-4,
    window: float = 1.0,
    every: int | None = None,
) -> Shooting:
    """The recording on the step grid, in windows of about `window` seconds, each with its measured initial state.

    `values` gives the initial pressures of unmeasured chambers. `every` steps make a row; by default there is one row
    for each sample where the samples allow it.
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
        # the plant's step takes pressures: a force is one chamber's pressure times its area
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
    """The ticks at which intervals with unknown inputs begin and end; each is a window, and the piston's state after it
    is fitted again."""
    spans = np.round(np.array(observation.undriven).reshape(-1, 2) / TICK).astype(np.int64)
    return spans[:, 0], spans[:, 1]


def _restarts(edges: Integers, at: Integers) -> tuple[int, ...]:
    """The windows at whose begin the plant's inputs become unknown, or known again."""
    return tuple(int(window) for window in np.flatnonzero(np.isin(edges[:-1], at)) if window)


def _edges(ticks: int, count: int, changes: Integers) -> Integers:
    """About `count` windows of equal length, and a new window at each of `changes`."""
    even = np.round(np.linspace(0, ticks, count + 1)).astype(np.int64)
    shortest = 0.3 * ticks / count
    inner = [edge for edge in even[1:-1] if np.all(np.abs(changes - edge) > shortest)]
    return np.unique(np.concatenate([[0, ticks], inner, changes[(changes > 0) & (changes < ticks)]]).astype(np.int64))


def coarser(fine: Shooting, step_size: float) -> Shooting:
    """The same windows and samples at a larger step size, for derivatives."""
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
        # a sample next to a window's edge is extrapolated from inside the window
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
    """Steps per row: one row per sample for evenly sampled channels, else close enough to interpolate the oil's fast
    motion."""
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
    """The places of a channel's samples on the rows: row r is at time (r + 1) per_row. No sample uses two windows."""
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
    return _through(channel, length, derivative, spacing)


def _through(channel: Measured, length: int, derivative: int = 0, spacing: float = 1.0) -> Array:
    """A local cubic through so many samples, or its derivative, at each sample; never through samples on both sides of
    a gap, for samples are taken to be evenly spaced."""
    filtered = np.empty(len(channel.values))
    gaps = np.diff(channel.time)
    breaks = np.flatnonzero(gaps > max(GAP * float(np.median(gaps)), 0.25 * SPAN)) + 1
    for piece in np.split(np.arange(len(filtered)), breaks):
        size = min(length, len(piece) - 1 + len(piece) % 2)
        filtered[piece] = savgol_filter(channel.values[piece], size, min(3, size - 1), deriv=derivative, delta=spacing)
    return filtered


def _length(channel: Measured, span: float) -> tuple[int, float]:
    """The number of samples within `span` seconds, odd, at least five and at most all; and the sampling period [s]."""
    spacing = float(np.median(np.diff(channel.time)))
    length = max(5, 2 * int(0.5 * span / spacing) + 1)
    return min(length, len(channel.values) - 1 + len(channel.values) % 2), spacing


def follow(channel: Measured) -> Array:
    """A channel with most of its noise removed, at each sample: as `smooth`, but through fewer samples where the two
    differ by more than noise (O. V. Lepskii, Theory Probab. Appl. 35, 1990).

    It gives the initial states of windows and of lagging sensors: where pressures bend, a cubic through 20 ms may be
    wrong by several times the noise, which is visible until the sensor's lag has decayed.
    """
    longest, _ = _length(channel, SPAN)
    closer, agrees = [(channel.values, 1.0)], np.ones(len(channel.values), dtype=bool)
    followed = channel.values
    for length in sorted({length for length in (longest // 4 | 1, longest // 2 | 1, longest) if length >= 5}):
        cubic = _through(channel, length)
        # the middle sample's weight is the share of the noise's variance that a least-squares fit retains there; an
        # estimate from fewer of the same samples differs from it by the difference of their variances
        share = float(savgol_coeffs(length, 3)[length // 2])
        for shorter, of_shorter in closer:
            agrees &= np.abs(cubic - shorter) < BENT * channel.noise * np.sqrt(of_shorter - share)
        followed = np.where(agrees, cubic, followed)
        closer.append((cubic, share))
    return followed


def held_out(windows: int) -> Sequence[int]:
    """The held-out windows: every third, the middle one of each three."""
    return range(1, windows, 3)
