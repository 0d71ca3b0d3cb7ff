"""The least-squares problem of a fit: residuals of data, continuity defects and priors, and their derivatives.

The continuity defect between a window's end and the next one's start is weighted by LINK: tight enough to detect slow
drifts, loose enough that a wrong model's error does not accumulate over the record.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from eha_core.compiled import compiled
from eha_core.identification.free_parameters import FreeParameter, values_at
from eha_core.identification.normal_matrix import NormalMatrix
from eha_core.identification.numbers import Array, Flags, Integers
from eha_core.identification.parallel import each, threads
from eha_core.identification.segments import coarser
from eha_core.identification.shooting import SLOPE_STEP, STATE_SIZE, Shooting
from eha_core.plant.lane_rows import LANES, REGISTER

LINK = np.array([3e-5, 3e-3, 3e4, 3e4])
"""Standard deviation of the continuity defects: m, m/s, Pa, Pa."""

STATE_STEP = np.array([1e-6, 1e-4, 1e3, 1e3])
STATE_PRIOR = np.array([1.0, 10.0, 3e6, 3e6])
"""A weak prior on the initial states, which matters only where a pressure was not measured."""


Point = tuple[Mapping[str, float], Array]
"""Every parameter of the plant, and the windows' states (windows, 4)."""


@dataclass(frozen=True)
class Problem:
    """The data of a fit: the windows in use, and the step size of its derivatives."""

    shooting: Shooting
    windows: Integers
    slope_step: float = SLOPE_STEP

    @cached_property
    def slopes(self) -> Shooting:
        """The same windows at the step size of the derivatives."""
        return coarser(self.shooting, self.slope_step)

    def used(self) -> Flags:
        """Flags of the windows in use."""
        flags = np.zeros(self.shooting.windows, dtype=np.bool_)
        flags[self.windows] = True
        return flags

    def count(self) -> int:
        """The number of samples in use."""
        used = self.used()
        return sum(int(used[sampling.window].sum()) for sampling in self.shooting.samplings)

    def links(self) -> Integers:
        """Windows with a continuity defect: in use, as is the next one, of the same recording and with known inputs."""
        used = self.used()
        follows = np.ones(self.shooting.windows, dtype=np.bool_)
        follows[[*self.shooting.first_windows, *self.shooting.restarts]] = False
        return np.flatnonzero(used[:-1] & used[1:] & follows[1:])

    @cached_property
    def order(self) -> tuple[Integers, Integers, list[Flags]]:
        """The order that sorts the samples in use, channel after channel, by window; their windows; and flags of those
        in use."""
        used = self.used()
        keep = [used[sampling.window] for sampling in self.shooting.samplings]
        window = np.concatenate(
            [sampling.window[flags] for sampling, flags in zip(self.shooting.samplings, keep, strict=True)]
        )
        order = np.argsort(window, kind="stable")
        return order, window[order], keep

    @cached_property
    def places(self) -> list[Integers]:
        """The index in `flat` of each sample in use, for each channel."""
        order, _, keep = self.order
        return np.split(np.argsort(order, kind="stable"), np.cumsum([flags.sum() for flags in keep])[:-1])

    def flat(self, samples: Iterable[Array]) -> Array:
        """The samples in use of all channels, divided by the noise, as one vector sorted by window."""
        order, _, keep = self.order
        pieces = zip(self.shooting.samplings, samples, keep, strict=True)
        return np.concatenate([values[flags] / sampling.noise for sampling, values, flags in pieces])[order]

    def flat_times(self) -> Array:
        """The time [s] of each sample in use, in the order of `flat`."""
        order, _, keep = self.order
        pairs = zip(self.shooting.samplings, keep, strict=True)
        return np.concatenate([self.shooting.times(sampling)[flags] for sampling, flags in pairs])[order]


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


def simulate(
    shooting: Shooting, values: Mapping[str, float], free: Sequence[FreeParameter], q: Array, states: Array
) -> tuple[Array, Array]:
    return shooting.simulate(values_at(values, free, q), states)


def residuals(shooting: Shooting, rows: Array) -> tuple[Array, ...]:
    """Measured minus simulated, divided by the noise, for each channel."""
    return tuple(
        (sampling.values - model) / sampling.noise
        for sampling, model in zip(shooting.samplings, shooting.sample(rows), strict=True)
    )


def objective_of(
    problem: Problem, free: Sequence[FreeParameter], q: Array, states: Array, rows: Array, ends: Array
) -> float:
    used, shooting = problem.used(), problem.shooting
    total = 0.0
    for sampling, residual in zip(shooting.samplings, residuals(shooting, rows), strict=True):
        total += float(np.sum(residual[used[sampling.window]] ** 2))
    links, size = problem.links(), shooting.free_states
    gaps = ((ends[links] - states[links + 1]) / LINK)[:, :size]
    total += float(np.sum(gaps**2))
    total += float(np.sum((((states - shooting.initial_states) / STATE_PRIOR)[used, :size]) ** 2))
    total += sum((float(at) / parameter.prior_deviation) ** 2 for parameter, at in zip(free, q, strict=True))
    return total if np.isfinite(total) else np.inf


def objectives_at(problem: Problem, points: Sequence[Point]) -> list[float]:
    """The objective without priors at several points, at the step size of the derivatives."""
    coarse, found = replace(problem, shooting=problem.slopes), []
    for first in range(0, len(points), LANES):
        some = points[first : first + LANES]
        rows, ends = coarse.shooting.simulate_many(some)
        for lane, (_, states) in enumerate(some):
            found.append(objective_of(coarse, (), np.zeros(0), states, rows[:, :, lane], ends[:, :, lane]))
    return found


def linearise(
    problem: Problem,
    values: Mapping[str, float],
    free: Sequence[FreeParameter],
    q: Array,
    states: Array,
    steps: Array | None = None,
    simulated: tuple[Array, Array] | None = None,
) -> Linearised:
    """Residuals and their derivatives by one-sided differences, with `steps` of each coordinate (1e-3 unless given).

    `simulated`: rows and ends at this point, if known.
    """
    shooting = problem.shooting
    steps = np.maximum(1e-3, [parameter.resolution for parameter in free]) if steps is None else steps
    rows, ends = simulated or simulate(shooting, values, free, q, states)
    base = shooting.sample(rows)
    here = values_at(values, free, q)
    moves, moved = [], []
    for place, parameter in enumerate(free):
        there, move = q.copy(), float(steps[place])
        # step inwards where a step outwards would meet the bound
        if parameter.value(float(q[place]) + move) == parameter.value(float(q[place])):
            move = -move
        there[place] += move
        moves.append(move)
        moved.append((values_at(values, free, there), states))
    for place in range(shooting.free_states):
        shifted = states.copy()
        shifted[:, place] += STATE_STEP[place]
        moves.append(float(STATE_STEP[place]))
        moved.append((here, shifted))
    columns, ends_by = changes(problem, (here, states), moved, moves)
    return Linearised(
        base,
        problem.flat(sampling.values - at for sampling, at in zip(shooting.samplings, base, strict=True)),
        np.ascontiguousarray(columns[:, : len(free)]),
        np.ascontiguousarray(columns[:, len(free) :]),
        problem.order[1],
        ends,
        ends_by[:, :, : len(free)],
        ends_by[:, :, len(free) :],
    )


def changes(
    problem: Problem, base: Point, moved: Sequence[Point], moves: Sequence[float] | None = None
) -> tuple[Array, Array]:
    """The changes from `base` to each of `moved`, at the step size of the derivatives, divided by `moves`, if given.

    Returns those of the samples in use, in units of noise (samples, moved), and of the windows' end states (windows, 4,
    moved). Each block that is simulated in lock-step has `base` in its first lane.
    """
    coarse = problem.slopes
    blocks = max(1, -(-len(moved) // (LANES - 1)), min(threads(), len(moved) // REGISTER))
    lanes = 1 + -(-len(moved) // blocks)
    room = min(LANES, -(-lanes // REGISTER) * REGISTER) - 1
    over = np.ones(len(moved)) if moves is None else np.asarray(moves)
    columns = np.empty((problem.count(), len(moved)))
    ends_by = np.empty((coarse.windows, STATE_SIZE, len(moved)))

    def fill(place: int) -> None:
        block = slice(place, place + room)
        rows, ends = coarse.simulate_many([base, *moved[block]])
        ends_by[:, :, block] = (ends[:, :, 1:] - ends[:, :, :1]) / over[block]
        for sampling, used, to in zip(coarse.samplings, problem.order[2], problem.places, strict=True):
            _sample_changes(
                rows, over[block], sampling.row[used], sampling.late[used], sampling.column, sampling.noise, to, place,
                columns,
            )  # fmt: skip

    each(fill, range(0, len(moved), room))
    return columns, ends_by


@compiled
def _sample_changes(
    rows: Array, over: Array, row: Integers, late: Array, column: int, noise: float, to: Integers, place: int,
    columns: Array,
) -> None:  # fmt: skip
    """Sample the changes of a block's sets from its first one: sample k of a channel fills row to[k] of `columns`, from
    column `place` on."""
    for k in range(len(row)):
        here, after = rows[row[k], column], rows[row[k] + 1, column]
        for lane in range(len(over)):
            change = (1.0 - late[k]) * ((here[lane + 1] - here[0]) / over[lane])
            change += late[k] * ((after[lane + 1] - after[0]) / over[lane])
            columns[to[k], place + lane] = change / noise


def normal_equations(
    problem: Problem, free: Sequence[FreeParameter], q: Array, states: Array, linear: Linearised
) -> tuple[NormalMatrix, Array]:
    """J^T J and J^T r over (q, states of every window); windows not in use are held by their prior."""
    shooting, used = problem.shooting, problem.used()
    windows, size = shooting.windows, shooting.free_states
    own, shared = np.zeros((windows, STATE_SIZE, STATE_SIZE)), np.zeros((windows, STATE_SIZE, len(free)))
    following, towards = np.zeros((windows - 1, STATE_SIZE, STATE_SIZE)), np.zeros((windows, STATE_SIZE))
    bounds = np.searchsorted(linear.window, np.arange(windows + 1))
    for window in np.flatnonzero(used):
        piece = slice(bounds[window], bounds[window + 1])
        by_state = linear.by_state[piece]
        own[window, :size, :size] = by_state.T @ by_state
        shared[window, :size] = by_state.T @ linear.by_parameter[piece]
        towards[window, :size] = by_state.T @ linear.residual[piece]
    links, weight = problem.links(), 1.0 / LINK[:size]
    by_parameter = linear.ends_by_parameter[links, :size] * weight[:, None]
    by_start = np.swapaxes(linear.ends_by_state[links, :size] * weight[:, None], 1, 2)
    gap = (linear.ends[links] - states[links + 1])[:, :size] * weight
    own[links, :size, :size] += by_start @ np.swapaxes(by_start, 1, 2)
    own[links + 1, :size, :size] += np.diag(weight**2)
    following[links, :size, :size] = -by_start * weight
    shared[links, :size] += by_start @ by_parameter
    shared[links + 1, :size] -= by_parameter * weight[:, None]
    towards[links, :size] -= (by_start @ gap[:, :, None])[:, :, 0]
    towards[links + 1, :size] += gap * weight
    prior = np.array([1.0 / parameter.prior_deviation**2 for parameter in free])
    own += np.diag(1.0 / STATE_PRIOR**2)
    towards -= (states - shooting.initial_states) / STATE_PRIOR**2
    flat = by_parameter.reshape(gap.size, len(free))
    parameters = linear.by_parameter.T @ linear.by_parameter + flat.T @ flat + np.diag(prior)
    gradient = linear.by_parameter.T @ linear.residual - flat.T @ gap.ravel() - prior * q
    return NormalMatrix(parameters, shared, own, following), np.concatenate([gradient, towards.ravel()])
