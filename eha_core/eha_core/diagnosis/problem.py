"""The least-squares problem behind a fit: residuals of data, links and priors, and their derivatives.

A window's end must meet the next one's start within LINK: tight enough that slow drifts tell, loose enough that a wrong
model does not carry its error through the record.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eha_core.diagnosis.freedom import Free
from eha_core.diagnosis.numbers import Array, Flags, Integers
from eha_core.diagnosis.parallel import each
from eha_core.diagnosis.shooting import SLOPE_STEP, STATE_SIZE, Shooting, coarser

LINK = np.array([3e-5, 3e-3, 3e4, 3e4])
"""How well a window's end meets the next one's start: m, m/s, Pa, Pa."""

STATE_STEP = np.array([1e-6, 1e-4, 1e3, 1e3])
STATE_TRUST = np.array([1.0, 10.0, 3e6, 3e6])
"""A weak prior on the starts, which matters only where a pressure was not measured."""


@dataclass(frozen=True)
class Problem:
    """What a fit explains: the windows in use, and the step at which it takes derivatives."""

    shooting: Shooting
    windows: Integers
    slope_step: float = SLOPE_STEP

    @cached_property
    def slopes(self) -> Shooting:
        """The same windows at the step at which derivatives are taken."""
        return coarser(self.shooting, self.slope_step)

    def used(self) -> Flags:
        """Which windows count."""
        flags = np.zeros(self.shooting.windows, dtype=np.bool_)
        flags[self.windows] = True
        return flags

    def count(self) -> int:
        """How many samples are in use."""
        used = self.used()
        return sum(int(used[one.window].sum()) for one in self.shooting.samplings)

    def links(self) -> Integers:
        """Windows in use whose successor is in use too."""
        used = self.used()
        return np.flatnonzero(used[:-1] & used[1:])

    @cached_property
    def order(self) -> tuple[Integers, Integers, list[Flags]]:
        """How the samples in use, channel after channel, are sorted by window; their windows; and which are in use."""
        used = self.used()
        keep = [used[one.window] for one in self.shooting.samplings]
        window = np.concatenate([one.window[flags] for one, flags in zip(self.shooting.samplings, keep, strict=True)])
        order = np.argsort(window, kind="stable")
        return order, window[order], keep

    def flat(self, samples: Iterable[Array]) -> Array:
        """One value a sample of each channel, over the noise: the samples in use as one vector, sorted by window."""
        order, _, keep = self.order
        pieces = zip(self.shooting.samplings, samples, keep, strict=True)
        return np.concatenate([values[flags] / one.noise for one, values, flags in pieces])[order]

    def flat_times(self) -> Array:
        """The time [s] of each sample in use, in the order of `flat`."""
        order, _, keep = self.order
        pairs = zip(self.shooting.samplings, keep, strict=True)
        return np.concatenate([self.shooting.times(one)[flags] for one, flags in pairs])[order]


@dataclass(frozen=True)
class Linearised:
    """Residuals and their derivatives, data grouped by window."""

    base: list[Array]
    residual: Array
    by_parameter: Array
    by_state: Array
    window: Integers
    ends: Array
    ends_by_parameter: Array
    ends_by_state: Array


def whole(shooting: Shooting) -> Problem:
    """The problem of fitting every window."""
    return Problem(shooting, np.arange(shooting.windows))


def values_at(values: Mapping[str, float], free: Sequence[Free], q: Array) -> dict[str, float]:
    return {**values, **{one.name: one.value(float(at)) for one, at in zip(free, q, strict=True)}}


def simulate(
    shooting: Shooting, values: Mapping[str, float], free: Sequence[Free], q: Array, states: Array
) -> tuple[Array, Array]:
    return shooting.simulate(values_at(values, free, q), states)


def residuals(shooting: Shooting, rows: Array) -> tuple[Array, ...]:
    """Measured less simulated, over the noise, channel by channel."""
    return tuple(
        (one.values - model) / one.noise for one, model in zip(shooting.samplings, shooting.sample(rows), strict=True)
    )


def objective_of(problem: Problem, free: Sequence[Free], q: Array, states: Array, rows: Array, ends: Array) -> float:
    used, shooting = problem.used(), problem.shooting
    total = 0.0
    for one, residual in zip(shooting.samplings, residuals(shooting, rows), strict=True):
        total += float(np.sum(residual[used[one.window]] ** 2))
    links, size = problem.links(), shooting.free_states
    gaps = ((ends[links] - states[links + 1]) / LINK)[:, :size]
    total += float(np.sum(gaps**2))
    total += float(np.sum((((states - shooting.initial_states) / STATE_TRUST)[used, :size]) ** 2))
    total += sum((float(at) / one.trust) ** 2 for one, at in zip(free, q, strict=True))
    return total if np.isfinite(total) else np.inf


def linearise(
    problem: Problem,
    values: Mapping[str, float],
    free: Sequence[Free],
    q: Array,
    states: Array,
    steps: Array | None = None,
) -> Linearised:
    """Residuals and their derivatives by one-sided differences, `steps` of each coordinate (1e-3 unless given)."""
    shooting, coarse = problem.shooting, problem.slopes
    steps = np.maximum(1e-3, [one.resolution for one in free]) if steps is None else steps
    rows, ends = simulate(shooting, values, free, q, states)
    base = shooting.sample(rows)
    coarse_rows, coarse_ends = simulate(coarse, values, free, q, states)

    def by_parameter(place: int) -> tuple[Array, Array]:
        moved, step = q.copy(), float(steps[place])
        # step inwards where a step outwards would meet the bound
        if free[place].value(float(q[place]) + step) == free[place].value(float(q[place])):
            step = -step
        moved[place] += step
        return differences(*simulate(coarse, values, free, moved, states), step)

    def by_state(place: int) -> tuple[Array, Array]:
        moved, step = states.copy(), float(STATE_STEP[place])
        moved[:, place] += step
        return differences(*simulate(coarse, values, free, q, moved), step)

    def differences(new_rows: Array, new_ends: Array, step: float) -> tuple[Array, Array]:
        return problem.flat(coarse.sample((new_rows - coarse_rows) / step)), (new_ends - coarse_ends) / step

    columns = each(by_parameter, range(len(free)))
    state_columns = each(by_state, range(shooting.free_states))
    window = problem.order[1]
    return Linearised(
        base,
        problem.flat(one.values - at for one, at in zip(shooting.samplings, base, strict=True)),
        np.stack([column for column, _ in columns], axis=1) if columns else np.zeros((len(window), 0)),
        np.stack([column for column, _ in state_columns], axis=1),
        window,
        ends,
        np.stack([end for _, end in columns], axis=2) if columns else np.zeros((*ends.shape, 0)),
        np.stack([end for _, end in state_columns], axis=2),
    )


def normal_equations(
    problem: Problem, free: Sequence[Free], q: Array, states: Array, linear: Linearised
) -> tuple[Array, Array]:
    """J^T J and J^T r over (q, states of every window, windows out of use held by their prior)."""
    shooting, used = problem.shooting, problem.used()
    parameters, size = len(free), shooting.free_states
    total = parameters + STATE_SIZE * shooting.windows
    normal, gradient = np.zeros((total, total)), np.zeros(total)
    normal[:parameters, :parameters] = linear.by_parameter.T @ linear.by_parameter
    gradient[:parameters] = linear.by_parameter.T @ linear.residual
    bounds = np.searchsorted(linear.window, np.arange(shooting.windows + 1))
    for window in np.flatnonzero(used):
        piece = slice(bounds[window], bounds[window + 1])
        place = parameters + STATE_SIZE * window + np.arange(size)
        own, shared = linear.by_state[piece], linear.by_parameter[piece]
        normal[np.ix_(place, place)] += own.T @ own
        cross = shared.T @ own
        normal[:parameters, place] += cross
        normal[place, :parameters] += cross.T
        gradient[place] += own.T @ linear.residual[piece]
    for window in problem.links():
        place = parameters + STATE_SIZE * window + np.arange(size)
        rows = np.zeros((size, total))
        rows[:, :parameters] = linear.ends_by_parameter[window, :size]
        rows[:, place] = linear.ends_by_state[window, :size]
        rows[:, place + STATE_SIZE] = -np.eye(size)
        rows /= LINK[:size, None]
        gap = (linear.ends[window] - states[window + 1])[:size] / LINK[:size]
        normal += rows.T @ rows
        gradient -= rows.T @ gap
    weights = np.tile(1.0 / STATE_TRUST**2, shooting.windows)
    diagonal = np.concatenate([[1.0 / one.trust**2 for one in free], weights])
    normal[np.diag_indices(total)] += diagonal
    offsets = np.concatenate([q, (states - shooting.initial_states).ravel()])
    gradient -= diagonal * offsets
    return normal, gradient
