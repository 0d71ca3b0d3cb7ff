"""Effects that act over an interval only: the windows in a row in which each would explain most, as options of a set.

A column that acts in some windows alone is the whole column with zeros elsewhere, so no further simulation is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from eha_core.diagnosis.criteria import FEW_SPANS, MOST_SPANS, OF_SIZE, OUTSTANDING
from eha_core.diagnosis.search.columns import Column
from eha_core.identification.fit import Fit
from eha_core.identification.normal_matrix import Eliminated
from eha_core.identification.numbers import Array, Integers
from eha_core.identification.problem import LINK, Linearised, Problem
from eha_core.identification.shooting import STATE_SIZE


@dataclass(frozen=True)
class Interval:
    """Windows in a row, the first and the one after the last, in which a column (by its place) acts alone, and the gain
    in chi^2 predicted of that."""

    column: int
    windows: tuple[int, int]
    gain: float


def best_intervals(
    problem: Problem,
    at: Fit,
    linear: Linearised,
    system: Eliminated,
    gradient: Array,
    columns: Sequence[Column],
    moved: Array,
    shifts: Array,
) -> list[Interval]:
    """For each of a few effects the column and interval that gain most; none where no gain stands out.

    `moved` (samples, columns) and `shifts` of the windows' ends: what each column changes. All columns are asked over
    few spans, and those that lead there over many.
    """
    if problem.shooting.windows < 2:
        return []
    towards = system.solve(gradient)

    def asked(places: Sequence[int], most: int) -> tuple[float, list[Interval], list[Interval]]:
        spans = _spans(problem.shooting.recordings, most)
        recordings = [range(*np.searchsorted(spans, (w.start, w.stop))) for w in problem.shooting.recordings]
        by_span = _by_span(problem, at, linear, moved[:, places], shifts[:, :, places], spans)
        always, limited, onsets = 0.0, dict[str, Interval](), dict[str, Interval]()
        for k, place in enumerate(places):
            column, overlap = columns[place], by_span.overlap(k)
            along, imitated = by_span.along[:, k] - towards @ overlap, system.energy(overlap)
            sets_in = onset_of(column) is not None
            whole, interval = _best_interval(
                column, spans, by_span.energy[:, k], along, imitated, recordings, to_the_end=sets_in
            )
            best = onsets if sets_in else limited
            always = always if sets_in else max(always, whole)
            known = best.get(column.effect.id)
            if interval is not None and (known is None or interval[1] > known.gain):
                best[column.effect.id] = Interval(place, *interval)
        leading = sorted(limited.values(), key=lambda interval: -interval.gain)[:OF_SIZE]
        return always, leading, list(onsets.values())

    always, limited, onsets = asked([k for k, column in enumerate(columns) if column.effect.acting_names()], FEW_SPANS)
    _, limited, onsets = asked([interval.column for interval in (*limited, *onsets)], MOST_SPANS)
    return [*onsets, *(limited if limited and limited[0].gain > OUTSTANDING * always else [])]


def in_interval(problem: Problem, column: Column, windows: tuple[int, int]) -> Column:
    """A column that acts in some windows only."""
    local = problem.shooting.local_edges
    begin, end = float(local[windows[0], 0]), float(local[windows[1] - 1, 1])
    there = in_span(column, (begin, end))
    return there if there.limited else replace(there, alternative=len(column.values) + windows[0])


def in_span(column: Column, span: tuple[float, float]) -> Column:
    """A column that acts from when until when [s] only; of an effect that sets in, one that does so at the first."""
    onset = onset_of(column)
    if onset is not None:
        return replace(column, values={**column.values, onset: span[0]})
    acts = dict(zip(column.effect.acting_names(), span, strict=True))
    return replace(column, values={**column.values, **acts}, limited=True)


def onset_of(column: Column) -> str | None:
    """The name of the instant at which an effect sets in; None of one that has no such instant."""
    for name, row in zip(column.effect.parameter_names(), column.effect.parameters, strict=True):
        if row.relative_to == "time" and not row.logarithmic:
            return name
    return None


def restricted(problem: Problem, moved: Array, shifts: Array, windows: tuple[int, int]) -> tuple[Array, Array]:
    """What a column changes where it acts in some windows alone."""
    inside = (problem.order[1] >= windows[0]) & (problem.order[1] < windows[1])
    ends = np.zeros_like(shifts)
    ends[windows[0] : windows[1]] = shifts[windows[0] : windows[1]]
    return moved * inside[:, None], ends


def _spans(recordings: Sequence[range], most: int) -> Integers:
    """The windows at which spans begin, and the end. A span is a window where there are few, and of one recording."""
    windows = recordings[-1].stop
    edges = [
        np.linspace(
            recording.start,
            recording.stop,
            min(len(recording), max(1, round(most * len(recording) / windows))) + 1,
        )
        for recording in recordings
    ]
    found: Integers = np.unique(np.round(np.concatenate(edges)).astype(np.int64))
    return found


@dataclass(frozen=True)
class _Overlaps:
    """What each guess changes in each span of windows alone.

    Attributes:
        energy: (spans, guesses). along: (spans, guesses) its product with the residual.
        by_parameter: (spans, parameters, guesses) its product with what each parameter changes.
        by_state: (windows, states, guesses) with what a window's own states change.
        by_next: (windows, states, guesses) with what the states of the window after it change, through the link.
        span_of: (windows,) the span of each.
    """

    energy: Array
    along: Array
    by_parameter: Array
    by_state: Array
    by_next: Array
    span_of: Integers

    def overlap(self, place: int) -> Array:
        """One guess's product with every column that can imitate it: (columns, spans)."""
        windows, states, _ = self.by_state.shape
        spans, parameters, _ = self.by_parameter.shape
        found = np.zeros((parameters + windows * states, spans))
        found[:parameters] = self.by_parameter[:, :, place].T
        rows = parameters + np.arange(windows * states)
        column = np.repeat(self.span_of, states)
        found[rows, column] = self.by_state[:, :, place].ravel()
        found[rows[states:], column[:-states]] += self.by_next[:-1, :, place].ravel()
        return found


def _by_span(
    problem: Problem, calibrated: Fit, linear: Linearised, columns: Array, shifts: Array, spans: Integers
) -> _Overlaps:
    """What `columns` (samples, guesses) and `shifts` of the windows' ends have in common with the residual and with
    what can imitate them."""
    shooting, size, many = problem.shooting, problem.shooting.free_states, columns.shape[1]
    windows, count = shooting.windows, len(calibrated.free)
    bounds = np.searchsorted(linear.window, np.arange(windows + 1))
    span_of = np.repeat(np.arange(len(spans) - 1), np.diff(spans))
    energy, along = np.zeros((len(spans) - 1, many)), np.zeros((len(spans) - 1, many))
    by_parameter = np.zeros((len(spans) - 1, count, many))
    by_state, by_next = np.zeros((windows, STATE_SIZE, many)), np.zeros((windows, STATE_SIZE, many))
    for window, span in enumerate(span_of):
        piece = slice(bounds[window], bounds[window + 1])
        part = columns[piece]
        energy[span] += np.einsum("ij,ij->j", part, part)
        along[span] += linear.residual[piece] @ part
        by_parameter[span] += linear.by_parameter[piece].T @ part
        by_state[window, :size] = linear.by_state[piece].T @ part
    link = LINK[:size]
    for window in problem.links():
        span = span_of[window]
        moved = shifts[window, :size] / link[:, None]
        energy[span] += np.einsum("ij,ij->j", moved, moved)
        along[span] -= ((linear.ends[window] - calibrated.states[window + 1])[:size] / link) @ moved
        by_parameter[span] += (linear.ends_by_parameter[window, :size] / link[:, None]).T @ moved
        by_state[window, :size] += (linear.ends_by_state[window, :size] / link[:, None]).T @ moved
        by_next[window, :size] = -moved / link[:, None]
    return _Overlaps(energy, along, by_parameter, by_state, by_next, span_of)


def _best_interval(
    column: Column,
    spans: Integers,
    energy: Array,
    along: Array,
    imitated: Array,
    recordings: Sequence[range],
    to_the_end: bool,
) -> tuple[float, tuple[tuple[int, int], float] | None]:
    """The gain predicted of a column over all spans, and the best over some of them in a row, of one recording;
    `to_the_end` of the record where the effect does not cease.

    `along` is free of what can be imitated; `imitated` (spans, spans) is what can be of each pair's energy.
    """
    count = len(energy)
    first, last = np.triu_indices(count)
    stop = last + 1
    begins = np.repeat([recording.start for recording in recordings], [len(recording) for recording in recordings])
    total = np.concatenate([[0.0], np.cumsum(energy)])
    towards = np.concatenate([[0.0], np.cumsum(along)])
    square = np.zeros((count + 1, count + 1))
    square[1:, 1:] = imitated.cumsum(axis=0).cumsum(axis=1)
    whole = total[stop] - total[first]
    left = whole - (square[stop, stop] - square[first, stop] - square[stop, first] + square[first, first])
    product = towards[stop] - towards[first]
    usable = (left > 1e-9 * whole) & (whole > 0.0)
    if column.one_way:
        usable &= product > 0.0
    gain = np.where(usable, product * product / np.where(usable, left, 1.0), 0.0)
    always = count - 1  # of the ranges that begin at the first span, the one that ends with the last
    over_all = float(gain[always])
    gain[always] = -1.0
    gain[begins[first] != begins[last]] = -1.0
    if to_the_end:
        gain[last != count - 1] = -1.0
    best = int(np.argmax(gain))
    if gain[best] <= 0.0:
        return over_all, None
    return over_all, ((int(spans[first[best]]), int(spans[stop[best]])), float(gain[best]))
