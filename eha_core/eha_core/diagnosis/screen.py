"""Stage 4a, screen: how much of what the calibrated model leaves unexplained could each hypothesis explain?

An effect switched on at a start changes the simulated channels by d. Whatever of d the windows' states and the nominal
parameters could imitate is projected out; the rest, d', promises a gain in chi^2 of (d'.r)^2 / (d'.d').
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from eha_core.diagnosis.fit import Fit
from eha_core.diagnosis.hypotheses import Start
from eha_core.diagnosis.parallel import each
from eha_core.diagnosis.problem import LINK, Problem, linearise, normal_equations
from eha_core.diagnosis.shooting import STATE_SIZE


@dataclass(frozen=True)
class Promise:
    """A start, the gain in chi^2 that it promises, and the factor on its size at which it promises that."""

    start: Start
    gain: float
    factor: float


def screen(problem: Problem, calibrated: Fit, starts: Sequence[Start]) -> tuple[Promise, ...]:
    """The promise of every start, the largest first."""
    linear = linearise(problem, calibrated.values, calibrated.free, calibrated.q, calibrated.states)
    normal, gradient = normal_equations(problem, calibrated.free, calibrated.q, calibrated.states, linear)
    factor = cho_factor(normal + 1e-9 * np.diag(np.diag(normal)))
    shooting, size = problem.shooting, problem.shooting.free_states
    parameters = len(calibrated.free)
    bounds = np.searchsorted(linear.window, np.arange(shooting.windows + 1))
    coarse = problem.slopes
    coarse_rows, coarse_ends = coarse.simulate(calibrated.values, calibrated.states)

    def promise(start: Start) -> Promise:
        rows, ends = coarse.simulate({**calibrated.values, **start.values}, calibrated.states)
        change = problem.flat(coarse.sample(rows - coarse_rows))
        if not np.all(np.isfinite(change)):
            return Promise(start, 0.0, 0.0)
        overlap = np.zeros(len(gradient))
        overlap[:parameters] = linear.by_parameter.T @ change
        for window in range(shooting.windows):
            piece = slice(bounds[window], bounds[window + 1])
            place = parameters + STATE_SIZE * window + np.arange(size)
            overlap[place] = linear.by_state[piece].T @ change[piece]
        energy, along = float(change @ change), float(change @ linear.residual)
        for window in problem.links():
            shift = ((ends - coarse_ends)[window, :size]) / LINK[:size]
            gap = (linear.ends[window] - calibrated.states[window + 1])[:size] / LINK[:size]
            place = parameters + STATE_SIZE * window + np.arange(size)
            overlap[:parameters] += (linear.ends_by_parameter[window, :size] / LINK[:size, None]).T @ shift
            overlap[place] += (linear.ends_by_state[window, :size] / LINK[:size, None]).T @ shift
            overlap[place + STATE_SIZE] -= shift / LINK[:size]
            energy += float(shift @ shift)
            along -= float(shift @ gap)
        solved = np.asarray(cho_solve(factor, overlap))
        left = energy - float(overlap @ solved)
        towards = along - float(gradient @ solved)
        if left <= 1e-9 * energy or energy == 0.0:
            return Promise(start, 0.0, 0.0)
        return Promise(start, towards * towards / left, towards / left)

    promises = each(promise, starts)
    return tuple(sorted(promises, key=lambda one: -one.gain))


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
    factor = float(np.sign(promise.factor) * np.clip(abs(promise.factor), 0.1, 10.0))
    values: dict[str, float] = {}
    for name, row in zip(promise.start.effect.parameter_names(), promise.start.effect.parameters, strict=True):
        value = promise.start.values[name]
        if row.switches:
            value = min(max(row.nominal + factor * (value - row.nominal), row.lower), row.upper)
        values[name] = value
    return values
