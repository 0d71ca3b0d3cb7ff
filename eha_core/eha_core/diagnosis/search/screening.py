"""Stage 4a, screen: how much of what the calibrated model leaves unexplained could each hypothesis explain?

An effect switched on at an initial guess changes the simulated channels by d. Whatever of d the windows' states and the
nominal parameters could imitate is projected out; the rest, d', predicts a gain in chi^2 of (d'.r)^2 / (d'.d').
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.search.initial_guesses import InitialGuess
from eha_core.identification.fit import Fit
from eha_core.identification.normal_matrix import Eliminated
from eha_core.identification.numbers import Array, Integers
from eha_core.identification.parallel import each, threads
from eha_core.identification.per_recording import named
from eha_core.identification.problem import LINK, Linearised, Problem, changes, linearise, normal_equations
from eha_core.identification.shooting import STATE_SIZE
from eha_core.plant.lane_rows import LANES

MOST_SPANS = 100
"""Where there are more windows, neighbours are taken together to ask since when and until when an effect acts, for the
answer has a number for each pair. A fit of the instants follows, so nothing hangs on a hundredth of the record."""


@dataclass(frozen=True)
class ScoreTest:
    """A guess, the gain in chi^2 predicted of it, and the factor on its size at which that is predicted; `windows`, the
    first and the one after the last, where it acts in these alone. `others`: the factors in further recordings, where
    its size differs between recordings."""

    guess: InitialGuess
    gain: float
    factor: float
    windows: tuple[int, int] | None = None
    others: tuple[float, ...] = ()


def screen(problem: Problem, calibrated: Fit, guesses: Sequence[InitialGuess]) -> tuple[ScoreTest, ...]:
    """The score test of every guess that acts all the time, the largest first."""
    return tuple(
        score_test for score_test in screen_in_time(problem, calibrated, guesses) if score_test.windows is None
    )


def screen_in_time(problem: Problem, calibrated: Fit, guesses: Sequence[InitialGuess]) -> tuple[ScoreTest, ...]:
    """The score test of every guess, the largest gain first: acting all the time, and in the windows where it gains
    most."""
    linear = linearise(problem, calibrated.values, calibrated.free, calibrated.q, calibrated.states)
    normal, gradient = normal_equations(problem, calibrated.free, calibrated.q, calibrated.states, linear)
    system = normal.eliminate(1e-9)
    towards = system.solve(gradient)
    spans = _spans(problem.shooting.recordings)
    found: list[ScoreTest] = []
    turns = -(-len(guesses) // (threads() * (LANES - 1)))  # so that a long record's changes need not all be kept
    room = -(-len(guesses) // max(1, turns)) or 1
    for first in range(0, len(guesses), room):
        some = guesses[first : first + room]
        found += _score_tests(problem, calibrated, linear, some, spans, (system, towards))
    return tuple(sorted(found, key=lambda score_test: -score_test.gain))


def _score_tests(
    problem: Problem,
    calibrated: Fit,
    linear: Linearised,
    guesses: Sequence[InitialGuess],
    spans: Integers,
    solution: tuple[Eliminated, Array],
) -> list[ScoreTest]:
    """The score tests of a few guesses. `solution`: the calibrated model's equations, and what they are solved by."""
    (system, towards), shooting = solution, problem.shooting
    at = calibrated.values, calibrated.states
    columns, shifts = changes(problem, at, [({**at[0], **guess.values}, at[1]) for guess in guesses])
    ran_away = ~np.all(np.isfinite(columns), axis=0)
    columns[:, ran_away], shifts[:, :, ran_away] = 0.0, 0.0
    found = _by_span(problem, calibrated, linear, columns, shifts, spans)
    recordings = [range(*np.searchsorted(spans, (windows.start, windows.stop))) for windows in shooting.recordings]

    def score_tests(place: int) -> list[ScoreTest]:
        guess = guesses[place]
        if ran_away[place]:
            return [ScoreTest(guess, 0.0, 0.0)]
        energy, overlap = found.energy[:, place], found.overlap(place)
        along, imitated = found.along[:, place] - towards @ overlap, overlap.T @ system.solve(overlap)
        if len(recordings) > 1 and any(name in shooting.per_recording for name in guess.values):
            return [_in_each_recording(guess, energy, along, imitated, recordings)]
        return _best_intervals(guess, spans, energy, along, imitated, recordings)

    return [score_test for several in each(score_tests, range(len(guesses))) for score_test in several]


def _spans(recordings: Sequence[range]) -> Integers:
    """The windows at which spans begin, and the end. A span is a window where there are few, and of one recording."""
    windows = recordings[-1].stop
    edges = [
        np.linspace(
            recording.start,
            recording.stop,
            min(len(recording), max(1, round(MOST_SPANS * len(recording) / windows))) + 1,
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


def _in_each_recording(
    guess: InitialGuess, energy: Array, along: Array, imitated: Array, recordings: Sequence[range]
) -> ScoreTest:
    """The score test with a size of its own in each recording: the gains of each alone, added up."""
    gains, factors = [], []
    for windows in recordings:
        own = slice(windows.start, windows.stop)
        left = float(energy[own].sum() - imitated[own, own].sum())
        usable = left > 1e-9 * float(energy[own].sum()) > 0.0
        factors.append(float(along[own].sum()) / left if usable else 0.0)
        gains.append(factors[-1] ** 2 * left if usable else 0.0)
    return ScoreTest(guess, sum(gains), factors[0], None, tuple(factors[1:]))


def _best_intervals(
    guess: InitialGuess, spans: Integers, energy: Array, along: Array, imitated: Array, recordings: Sequence[range]
) -> list[ScoreTest]:
    """The score test over all spans, and the best over some of them in a row, of one recording.

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
    divisor = np.where(usable, left, 1.0)
    gain = np.where(usable, product * product / divisor, 0.0)
    factor = np.where(usable, product / divisor, 0.0)
    always = count - 1  # of the ranges that begin at the first span, the one that ends with the last
    score_tests = [ScoreTest(guess, float(gain[always]), float(factor[always]))]
    if count > 1:
        gain = np.where(factor < 0.0, gain if _reversible(guess) else 0.0, gain)
        gain[always] = -1.0
        gain[begins[first] != begins[last]] = -1.0
        best = int(np.argmax(gain))
        interval = (int(spans[first[best]]), int(spans[stop[best]]))
        score_tests.append(ScoreTest(guess, float(gain[best]), float(factor[best]), interval))
    return score_tests


def one_each(score_tests: Sequence[ScoreTest], most: int) -> tuple[ScoreTest, ...]:
    """The best score test of each effect, `most` of them at most. A size cannot be negative where its bounds say so."""
    best: dict[str, ScoreTest] = {}
    for score_test in score_tests:
        if score_test.factor < 0.0 and not _reversible(score_test.guess):
            continue
        best.setdefault(score_test.guess.effect.id, score_test)
    return tuple(best.values())[:most]


def _reversible(guess: InitialGuess) -> bool:
    switches = [row for row in guess.effect.parameters if row.switches]
    return all(row.lower < row.nominal for row in switches)


def scaled(score_test: ScoreTest) -> dict[str, float]:
    """The guess's values with the sizes that switch the effect scaled by the predicted factor, within a decade and the
    bounds."""
    values = sized(score_test.guess, _within_a_decade(score_test.factor))
    for number, factor in enumerate(score_test.others, 2):
        own = sized(score_test.guess, _within_a_decade(factor))
        values |= {named(name, number): value for name, value in own.items() if value != score_test.guess.values[name]}
    return values


def _within_a_decade(factor: float) -> float:
    return float(np.sign(factor) * np.clip(abs(factor), 0.1, 10.0))


def sized(guess: InitialGuess, factor: float) -> dict[str, float]:
    """The guess's values with the sizes that switch the effect at so many times what they are, within their bounds."""
    values: dict[str, float] = {}
    for name, row in zip(guess.effect.parameter_names(), guess.effect.parameters, strict=True):
        value = guess.values[name]
        if row.switches:
            value = min(max(row.nominal + factor * (value - row.nominal), row.lower), row.upper)
        values[name] = value
    return values
