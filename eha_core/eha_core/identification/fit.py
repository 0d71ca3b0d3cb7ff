"""Soft multiple shooting: parameters and the windows' initial states fitted together, with weighted continuity defects.

Levenberg-Marquardt with finite differences; parameters that reach a bound stay there while the others adapt.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.linalg import LinAlgError

from eha_core.identification.free_parameters import LATE, FreeParameter, coordinates, values_at
from eha_core.identification.normal_matrix import NormalMatrix
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import base_name, in_each, is_one_of
from eha_core.identification.problem import (
    Problem,
    linearise,
    normal_equations,
    objective_of,
    residuals,
    simulate,
)
from eha_core.identification.shooting import STATE_SIZE, Shooting
from eha_core.parameters import catalogue
from eha_core.plant.lane_rows import REGISTER

SETTLED = 0.5
"""Chi^2; an iteration that gains less ends the fit."""

WORTH = 2e-4
"""Share of the excess chi^2; an iteration that gains less ends the fit of a model far from the noise."""

HOPE = 4.0
"""Times its last gain that a fit may still gain: gains that halve add up to one more, and some do not halve
(assumed)."""

UNDAMPED = 1e-10
"""The least damping, of the full step: columns that are one and the same still have one (assumed)."""

TRIALS = REGISTER
"""Dampings that an iteration tries where its own leads no lower, in lock-step; the last is 2e13 times the first, which
gives a negligible step."""


class Ending(Enum):
    """Why a fit ended."""

    CONVERGED = "an iteration gained next to nothing"
    NO_DESCENT = "no step along its derivatives led lower"
    HOPELESS = "it could not come near enough to the best so far"
    ITERATIONS = "it ran out of iterations"
    DIVERGED = "the simulation ran away"


@dataclass(frozen=True)
class Fit:
    """A fitted model.

    Attributes:
        free: the free parameters; `q` their coordinates, `covariance` of (q, the windows' states), in rows, with q.
        values: every parameter of the plant.
        states: (windows, 4) fitted initial states.
        objective: chi^2 of data, continuity and priors over the windows used; `data`: of the data alone.
        count: samples used.
        residuals: measured minus simulated, divided by the noise; one array for each channel (all windows).
        ending: why it ended.
    """

    free: tuple[FreeParameter, ...]
    q: Array
    values: Mapping[str, float]
    states: Array
    objective: float
    data: float
    count: int
    residuals: tuple[Array, ...]
    covariance: Array
    ending: Ending
    iterations: int

    def held_by_belief(self) -> frozenset[str]:
        """The plant's own parameters at a prior bound, one that is narrower than the catalogue's limit."""
        rows = catalogue()
        return frozenset(
            base_name(parameter.name)
            for parameter in self.free
            if "." not in parameter.name
            and parameter.is_bound_by(self.values[parameter.name])
            and self.values[parameter.name]
            not in (rows[base_name(parameter.name)].lower, rows[base_name(parameter.name)].upper)
        )

    def deviation(self, name: str) -> float:
        """Standard deviation of a fitted parameter's value, from the curvature at the optimum.

        An instant is known no better than the span over which its derivative is taken.
        """
        parameter = next(parameter for parameter in self.free if parameter.name == name)
        spread = float(np.sqrt(max(self.covariance_of([name])[0, 0], 0.0)))
        return max(spread, parameter.resolution / float(np.sqrt(12.0)) * parameter.slope(self.values[name]))

    def covariance_of(self, names: Sequence[str]) -> Array:
        """Covariance of fitted parameters' values, from the curvature at the optimum: (names, names)."""
        places = {parameter.name: place for place, parameter in enumerate(self.free)}
        by_coordinate = np.zeros((len(names), len(self.free)))
        for row, name in zip(by_coordinate, names, strict=True):
            parameter = self.free[places[name]]
            row[places[name]] = parameter.slope(self.values[name]) * (
                self.values[parameter.above] if parameter.above else 1.0
            )
            if parameter.above in places:
                below = self.values[parameter.above]
                times = self.values[name] / below if below > 0.0 else 1.0
                row[places[parameter.above]] = times * self.free[places[parameter.above]].slope(below)
        count = len(self.free)
        return by_coordinate @ self.covariance[:count, :count] @ by_coordinate.T


def fit(
    problem: Problem,
    values: Mapping[str, float],
    free: Sequence[FreeParameter],
    states: Array | None = None,
    *,
    iterations: int = 12,
    give_up_above: float = np.inf,
    in_a_row: int = 1,
) -> Fit:
    """Minimise data, continuity defects and priors over `free` and the states of the windows in use, from `values`.

    Stops when an iteration gains less than SETTLED, when `in_a_row` iterations gain too little (WORTH), or when further
    ones, at HOPE times the last gain, would not bring the objective below `give_up_above`. Where derivatives at the
    problem's slope step promise more than any step gains, it goes on with those at the simulation's own step.
    """
    shooting = problem.shooting
    free, values = in_each(free, values, shooting.per_recording, len(shooting.first_windows))
    states = (shooting.initial_states if states is None else states).copy()
    q = coordinates(free, values)
    resolution = np.array([parameter.resolution for parameter in free])
    steps = np.maximum(1e-3, resolution)
    rows, ends = simulate(shooting, values, free, q, states)
    objective = objective_of(problem, free, q, states, rows, ends)
    damping, ending, done, little = 1e-6, Ending.ITERATIONS, 0, 0
    normal = _unknowing(len(free), shooting.windows)
    for done in range(1, iterations + 1):
        linear = linearise(problem, values, free, q, states, steps, (rows, ends))
        normal, gradient = normal_equations(problem, free, q, states, linear)
        found = _descend(problem, values, free, _Point(q, states, rows, ends, objective), normal, gradient, damping)
        little_gained = found is None or objective - found[0].objective < SETTLED
        if little_gained and problem.slope_step > shooting.step_size and _promised(normal, gradient) > HOPE * SETTLED:
            problem = exact(problem)  # no step gains what these derivatives promise: they are too coarse
            continue
        if found is None:
            ending = Ending.NO_DESCENT
            break
        new, move, damping = found
        gain = objective - new.objective
        q, states, rows, ends, objective = new.q, new.states, new.rows, new.ends, new.objective
        ratio = gain / max(float(move @ (2.0 * gradient - normal.times(move))), 1e-300)
        damping = max(damping * (0.05 if ratio > 0.75 else 0.5 if ratio > 0.25 else 4.0), UNDAMPED)
        spread = np.sqrt(1.0 / np.maximum(np.diag(normal.parameters), 1e-12))
        steps = np.maximum(np.clip(0.3 * spread, 1e-6, 1e-2), resolution)
        little = little + 1 if gain < max(SETTLED, WORTH * (objective - problem.count())) else 0
        if gain < SETTLED or little == in_a_row:
            ending = Ending.CONVERGED
            break
        if done > 2 and objective - HOPE * gain > give_up_above:
            ending = Ending.HOPELESS
            break
    ending = ending if np.isfinite(objective) else Ending.DIVERGED
    return _finish(problem, values, free, q, states, rows, objective, normal, ending, done)


def _promised(normal: NormalMatrix, gradient: Array) -> float:
    """What the full step is predicted to gain, bounds aside."""
    try:
        return float(gradient @ normal.eliminate(UNDAMPED).solve(gradient))
    except (LinAlgError, ValueError):
        return np.inf


def _unknowing(parameters: int, windows: int) -> NormalMatrix:
    """The unit matrix, used before any derivative was computed."""
    own = np.tile(np.eye(STATE_SIZE), (windows, 1, 1))
    shared = np.zeros((windows, STATE_SIZE, parameters))
    return NormalMatrix(np.eye(parameters), shared, own, np.zeros((windows - 1, STATE_SIZE, STATE_SIZE)))


def exact(problem: Problem) -> Problem:
    """The same problem with derivatives at the simulation's own step size."""
    return replace(problem, slope_step=problem.shooting.step_size)


def fit_in_stages(
    problem: Problem,
    values: Mapping[str, float],
    free: Sequence[FreeParameter],
    states: Array | None = None,
    *,
    iterations: int = 30,
    give_up_above: float = np.inf,
) -> Fit:
    """`fit` from a distant initial guess: the parameters of LATE are held until the others have converged."""
    early = [parameter for parameter in free if not is_one_of(parameter.name, LATE)]
    first = fit(problem, values, early, states, iterations=8)
    return fit(problem, first.values, free, first.states, iterations=iterations, give_up_above=give_up_above)


def refit_states(problem: Problem, result: Fit, iterations: int = 4) -> Fit:
    """Hold the parameters of `result` and fit only the states of the problem's windows, as for held-out data."""
    return fit(problem, result.values, (), result.states, iterations=iterations)


@dataclass(frozen=True)
class _Point:
    """The current point of the search."""

    q: Array
    states: Array
    rows: Array
    ends: Array
    objective: float


def _descend(
    problem: Problem,
    values: Mapping[str, float],
    free: Sequence[FreeParameter],
    at: _Point,
    normal: NormalMatrix,
    gradient: Array,
    damping: float,
) -> tuple[_Point, Array, float] | None:
    """The first point with a lower objective as the damping grows, its step and that damping; None without one.

    Where the damping given leads no lower, TRIALS larger ones are simulated in lock-step. The lowest of them is not
    taken: along a curved valley it is a short step, and so is the next.
    """
    first, *larger = _growing(damping)
    for dampings in ([first], larger):
        steps = [(size, move) for size in dampings if (move := _step(normal, gradient, size, free, at.q)) is not None]
        points = _points(problem, values, free, [_moved(problem, free, at.q, at.states, move) for _, move in steps])
        for point, (size, move) in zip(points, steps, strict=True):
            if point.objective < at.objective:
                return point, move, size
    return None


def _growing(damping: float) -> list[float]:
    """The dampings that an iteration tries, with a factor between them that doubles each time."""
    dampings = [damping]
    for trial in range(TRIALS):
        dampings.append(max(dampings[-1] * 4.0 * 2.0**trial, 1e-8))
    return dampings


def _points(
    problem: Problem, values: Mapping[str, float], free: Sequence[FreeParameter], places: Sequence[tuple[Array, Array]]
) -> list[_Point]:
    """The objective at several coordinates and states: of one by itself, of several in lock-step."""
    shooting, found = problem.shooting, []
    if len(places) > 1:
        rows, ends = shooting.simulate_many([(values_at(values, free, q), states) for q, states in places])
        simulated = [(rows[:, :, lane], ends[:, :, lane]) for lane in range(len(places))]
    else:
        simulated = [simulate(shooting, values, free, q, states) for q, states in places]
    for (q, states), (rows, ends) in zip(places, simulated, strict=True):
        found.append(_Point(q, states, rows, ends, objective_of(problem, free, q, states, rows, ends)))
    return found


def _step(
    normal: NormalMatrix, gradient: Array, damping: float, free: Sequence[FreeParameter], q: Array
) -> Array | None:
    """The damped Gauss-Newton step; parameters that would pass a bound are put on it, and the others adapt."""
    count = len(free)
    fixed = np.zeros(count, dtype=np.bool_)
    move: Array = np.zeros(len(gradient))
    try:
        system = normal.eliminate(damping)
        for _ in range(4):
            move = system.solve(gradient, fixed, move[:count])
            crossing = False
            for place, parameter in enumerate(free):
                reached = float(q[place] + np.clip(move[place], -parameter.longest_move, parameter.longest_move))
                inside = parameter.coordinate(parameter.value(reached))
                if not fixed[place] and abs(inside - reached) > 1e-12:
                    move[place] = inside - q[place]
                    fixed[place] = crossing = True
            if not crossing:
                break
    except (LinAlgError, ValueError):
        return None
    return move


def _moved(
    problem: Problem, free: Sequence[FreeParameter], q: Array, states: Array, move: Array
) -> tuple[Array, Array]:
    longest = np.array([parameter.longest_move for parameter in free])
    new_q = q + np.clip(move[: len(free)], -longest, longest)
    new_states = states + np.where(problem.used()[:, None], move[len(free) :].reshape(states.shape), 0.0)
    return new_q, new_states


def _finish(
    problem: Problem,
    values: Mapping[str, float],
    free: tuple[FreeParameter, ...],
    q: Array,
    states: Array,
    rows: Array,
    objective: float,
    normal: NormalMatrix,
    ending: Ending,
    iterations: int,
) -> Fit:
    used = problem.used()
    left = residuals(problem.shooting, rows)
    data = sum(
        float(np.sum(r[used[sampling.window]] ** 2))
        for sampling, r in zip(problem.shooting.samplings, left, strict=True)
    )
    return Fit(
        free,
        q,
        values_at(values, free, q),
        states,
        objective,
        data,
        problem.count(),
        left,
        normal.covariance(),
        ending,
        iterations,
    )


def with_noise(shooting: Shooting, noise: Sequence[float]) -> Shooting:
    """The same recording with the channels' noise replaced."""
    pairs = zip(shooting.samplings, noise, strict=True)
    return replace(shooting, samplings=tuple(replace(sampling, noise=level) for sampling, level in pairs))
