"""Stage 4a, screen: how much of what the calibrated model leaves unexplained could each hypothesis explain?

An effect switched on at a start changes the simulated channels by d. Whatever of d the windows' states and the nominal
parameters could imitate is projected out; the rest, d', promises a gain in chi^2 of (d'.r)^2 / (d'.d').
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.fit import Fit
from eha_core.diagnosis.hypotheses import Start
from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.parallel import each
from eha_core.diagnosis.per_recording import named
from eha_core.diagnosis.problem import LINK, Linearised, Problem, changes, linearise, normal_equations
from eha_core.diagnosis.shooting import STATE_SIZE


@dataclass(frozen=True)
class Promise:
    """A start, the gain in chi^2 that it promises, and the factor on its size at which it promises that; `windows`, the
    first and the one after the last, where it acts in these alone. `others`: the factors in further recordings, where
    its size differs between recordings."""

    start: Start
    gain: float
    factor: float
    windows: tuple[int, int] | None = None
    others: tuple[float, ...] = ()


def screen(problem: Problem, calibrated: Fit, starts: Sequence[Start]) -> tuple[Promise, ...]:
    """The promise of every start that acts all the time, the largest first."""
    return tuple(one for one in screen_spells(problem, calibrated, starts) if one.windows is None)


def screen_spells(problem: Problem, calibrated: Fit, starts: Sequence[Start]) -> tuple[Promise, ...]:
    """The promise of every start, the largest first: acting all the time, and in the windows where it promises most."""
    linear = linearise(problem, calibrated.values, calibrated.free, calibrated.q, calibrated.states)
    normal, gradient = normal_equations(problem, calibrated.free, calibrated.q, calibrated.states, linear)
    system = normal.eliminate(1e-9)
    towards = system.solve(gradient)
    at = calibrated.values, calibrated.states
    columns, shifts = changes(problem, at, [({**at[0], **start.values}, at[1]) for start in starts])

    def promises(place: int) -> list[Promise]:
        start, change = starts[place], columns[:, place]
        if not np.all(np.isfinite(change)):
            return [Promise(start, 0.0, 0.0)]
        energy, along, overlap = _by_window(problem, calibrated, linear, change, shifts[:, :, place])
        along, imitated = along - towards @ overlap, overlap.T @ system.solve(overlap)
        shooting = problem.shooting
        if len(shooting.first_windows) > 1 and any(name in shooting.per_recording for name in start.values):
            return [_in_each_recording(start, energy, along, imitated, shooting.recordings)]
        return _best_spells(start, energy, along, imitated, shooting.recordings)

    found = [one for several in each(promises, range(len(starts))) for one in several]
    return tuple(sorted(found, key=lambda one: -one.gain))


def _by_window(
    problem: Problem, calibrated: Fit, linear: Linearised, change: Array, shift: Array
) -> tuple[Array, Array, Array]:
    """What an effect changes in each window alone: its energy (windows,), its product with the residual (windows,),
    and with every column that can imitate it (columns, windows)."""
    shooting, size, parameters = problem.shooting, problem.shooting.free_states, len(calibrated.free)
    windows = shooting.windows
    bounds = np.searchsorted(linear.window, np.arange(windows + 1))
    energy, along = np.zeros(windows), np.zeros(windows)
    overlap = np.zeros((parameters + STATE_SIZE * windows, windows))
    for window in range(windows):
        piece = slice(bounds[window], bounds[window + 1])
        place = parameters + STATE_SIZE * window + np.arange(size)
        part = change[piece]
        energy[window], along[window] = part @ part, part @ linear.residual[piece]
        overlap[:parameters, window] = linear.by_parameter[piece].T @ part
        overlap[place, window] = linear.by_state[piece].T @ part
    for window in problem.links():
        place = parameters + STATE_SIZE * window + np.arange(size)
        moved = shift[window, :size] / LINK[:size]
        gap = (linear.ends[window] - calibrated.states[window + 1])[:size] / LINK[:size]
        overlap[:parameters, window] += (linear.ends_by_parameter[window, :size] / LINK[:size, None]).T @ moved
        overlap[place, window] += (linear.ends_by_state[window, :size] / LINK[:size, None]).T @ moved
        overlap[place + STATE_SIZE, window] -= moved / LINK[:size]
        energy[window] += moved @ moved
        along[window] -= moved @ gap
    return energy, along, overlap


def _in_each_recording(
    start: Start, energy: Array, along: Array, imitated: Array, recordings: Sequence[range]
) -> Promise:
    """The promise of a size of its own in each recording: what each promises alone, added up."""
    gains, factors = [], []
    for windows in recordings:
        own = slice(windows.start, windows.stop)
        left = float(energy[own].sum() - imitated[own, own].sum())
        usable = left > 1e-9 * float(energy[own].sum()) > 0.0
        factors.append(float(along[own].sum()) / left if usable else 0.0)
        gains.append(factors[-1] ** 2 * left if usable else 0.0)
    return Promise(start, sum(gains), factors[0], None, tuple(factors[1:]))


def _best_spells(
    start: Start, energy: Array, along: Array, imitated: Array, recordings: Sequence[range]
) -> list[Promise]:
    """The promise over all windows, and the best over some of them in a row, of one recording.

    `along` is free of what can be imitated; `imitated` (windows, windows) is what can be of each pair's energy.
    """
    windows = len(energy)
    first, last = np.triu_indices(windows)
    stop = last + 1
    begins = np.repeat([one.start for one in recordings], [len(one) for one in recordings])
    total = np.concatenate([[0.0], np.cumsum(energy)])
    towards = np.concatenate([[0.0], np.cumsum(along)])
    square = np.zeros((windows + 1, windows + 1))
    square[1:, 1:] = imitated.cumsum(axis=0).cumsum(axis=1)
    whole = total[stop] - total[first]
    left = whole - (square[stop, stop] - square[first, stop] - square[stop, first] + square[first, first])
    product = towards[stop] - towards[first]
    usable = (left > 1e-9 * whole) & (whole > 0.0)
    divisor = np.where(usable, left, 1.0)
    gain = np.where(usable, product * product / divisor, 0.0)
    factor = np.where(usable, product / divisor, 0.0)
    always = windows - 1  # of the ranges that begin at the first window, the one that ends with the last
    promises = [Promise(start, float(gain[always]), float(factor[always]))]
    if windows > 1:
        gain = np.where(factor < 0.0, gain if _reversible(start) else 0.0, gain)
        gain[always] = -1.0
        gain[begins[first] != begins[last]] = -1.0
        best = int(np.argmax(gain))
        spell = (int(first[best]), int(stop[best]))
        promises.append(Promise(start, float(gain[best]), float(factor[best]), spell))
    return promises


def one_each(promises: Sequence[Promise], most: int) -> tuple[Promise, ...]:
    """The best promise of each effect, `most` of them at most. A size cannot be negative where its bounds say so."""
    best: dict[str, Promise] = {}
    for one in promises:
        if one.factor < 0.0 and not _reversible(one.start):
            continue
        best.setdefault(one.start.effect.id, one)
    return tuple(best.values())[:most]


def _reversible(start: Start) -> bool:
    switches = [row for row in start.effect.parameters if row.switches]
    return all(row.lower < row.nominal for row in switches)


def scaled(promise: Promise) -> dict[str, float]:
    """The start's values with the sizes that switch the effect scaled as promised, within a decade and the bounds."""
    values = sized(promise.start, _within_a_decade(promise.factor))
    for number, factor in enumerate(promise.others, 2):
        own = sized(promise.start, _within_a_decade(factor))
        values |= {named(name, number): value for name, value in own.items() if value != promise.start.values[name]}
    return values


def _within_a_decade(factor: float) -> float:
    return float(np.sign(factor) * np.clip(abs(factor), 0.1, 10.0))


def sized(start: Start, factor: float) -> dict[str, float]:
    """The start's values with the sizes that switch the effect at so many times what they are, within their bounds."""
    values: dict[str, float] = {}
    for name, row in zip(start.effect.parameter_names(), start.effect.parameters, strict=True):
        value = start.values[name]
        if row.switches:
            value = min(max(row.nominal + factor * (value - row.nominal), row.lower), row.upper)
        values[name] = value
    return values
