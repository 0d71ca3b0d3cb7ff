"""The quadratic model of chi^2 about a fitted set: every other set of effects is a point in it.

One Jacobian of the nominal parameters, the windows' states and the members' parameters, and one secant for each column
of the catalogue. The states are eliminated from the Gram matrix; the rest is small, and a set costs microseconds. A
move beyond a bound is no way to explain anything, so each is kept within its bounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve_banded

from eha_core.diagnosis.criteria import SMALLEST
from eha_core.diagnosis.hypothesis import Hypothesis, Member, neutral
from eha_core.diagnosis.search.box import within_bounds
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.derivatives import Derivatives, derivatives
from eha_core.diagnosis.search.intervals import best_intervals, in_interval, restricted
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array, Integers
from eha_core.identification.per_recording import base_name
from eha_core.identification.problem import Linearised, Problem, normal_equations

RIDGE = 1e-7
"""Of the unit diagonal, on moves from where the model was made: columns that are one and the same to seven digits share
a coefficient."""

ITS_OWN = 1e-6
"""Share of a column's energy that the nominal parameters must not be able to imitate for it to be an option."""


@dataclass(frozen=True)
class Option:
    """One way to have an effect in a set: the model's columns that belong to it. A present member has one option, with
    all its parameters; an effect to be added has one for each alternative of its guesses."""

    member: Member
    places: tuple[int, ...]
    columns: tuple[Column, ...] = ()

    @property
    def present(self) -> bool:
        """Whether the effect is in the set about which the model was made."""
        return not self.columns


@dataclass(frozen=True)
class QuadraticModel:
    """Chi^2 about a fitted set, with the windows' states eliminated: over moves of the nominal parameters, of the
    members' parameters and of the columns of what could be added, in this order, each within its bounds.

    Attributes:
        options: what a set can be made of.
        nominal: how many nominal parameters come first; they belong to every set.
        matrix: (moves, moves) the curvature, scaled to a unit diagonal.
        gradient: (moves,) where what could be absent is absent.
        lower, upper: (moves,) bounds, scaled.
        scale: (moves,) a move is its scaled value over this.
        empty: objective of the nominal parameters as they are, without any member.
        to_neutral: (moves,) from where the model was made to where what could be absent is absent.
        states_move, carried: what the states do by themselves, and per move.
    """

    at: Fit
    hypothesis: Hypothesis
    options: tuple[Option, ...]
    nominal: int
    matrix: Array
    gradient: Array
    lower: Array
    upper: Array
    scale: Array
    empty: float
    to_neutral: Array
    states_move: Array
    carried: Array

    def places_of(self, chosen: Sequence[Option]) -> Integers:
        """The moves that a set can make."""
        own = [place for option in chosen for place in option.places]
        return np.array([*range(self.nominal), *own], dtype=np.int64)

    def gain(self, chosen: Sequence[Option]) -> tuple[float, Array]:
        """What a set is predicted to gain over `empty`, and its moves (of `places_of`), unscaled."""
        places = self.places_of(chosen)
        found = np.empty(len(places))
        gain = within_bounds(self.matrix, self.gradient, self.lower, self.upper, places, len(places), found)
        return gain, found / self.scale[places]

    def start(self, chosen: Sequence[Option], share: float = 1.0) -> tuple[dict[str, float], Array]:
        """Values and states at a `share` of the way to a set's predicted optimum; what is not in the set is out."""
        free = self.at.free
        places, (_, found) = self.places_of(chosen), self.gain(chosen)
        moves = self.to_neutral.copy()
        moves[places] += found
        moves *= share
        states = self.at.states + (share * self.states_move - self.carried @ moves).reshape(self.at.states.shape)
        values = dict(self.at.values)
        for parameter, at in zip(free, self.at.q + moves[: len(free)], strict=True):
            values[parameter.name] = parameter.value(float(at))
        for parameter in free:
            if parameter.above:
                values[parameter.name] = values[parameter.above] * (1.0 + values[parameter.name])
        factors = dict(zip(places.tolist(), (share * found).tolist(), strict=True))
        return with_options(self.hypothesis, values, chosen, factors), states


def with_options(
    hypothesis: Hypothesis, values: Mapping[str, float], chosen: Sequence[Option], factors: Mapping[int, float]
) -> dict[str, float]:
    """Values of a set: the members that are not in it neutral, new ones sized by their coefficients."""
    kept = {option.member for option in chosen}
    made = dict(values)
    for member in hypothesis.members:
        if member not in kept:
            off = neutral(member.effect)
            made = {name: off.get(base_name(name), value) for name, value in made.items()}
    for option in chosen:
        if option.present:
            continue
        if option.member.variable:
            made |= _drawn(option, factors)
            continue
        for k, (place, column) in enumerate(zip(option.places, option.columns, strict=True)):
            factor = factors[place]
            sized = column.sized(float(np.sign(factor) or 1.0) * max(abs(factor), SMALLEST))
            made |= sized if k == 0 else {name: sized[name] for name in column.sizes}
    return made


def _drawn(option: Option, factors: Mapping[int, float]) -> dict[str, float]:
    """The curve that its columns draw together."""
    sizes = {name for column in option.columns for name in column.sizes}
    made = {name: value for name, value in option.columns[0].values.items() if name not in sizes}
    pairs = list(zip(option.places, option.columns, strict=True))
    return made | {name: sum(factors[place] * column.values[name] for place, column in pairs) for name in sizes}


def quadratic_model(
    problem: Problem,
    at: Fit,
    hypothesis: Hypothesis,
    plant: Sequence[FreeParameter],
    columns: Sequence[Column],
    in_time: bool = False,
) -> QuadraticModel:
    """Linearise about a fit of `hypothesis`, whose free parameters begin with those of the `plant`.

    `in_time`: effects that act over an interval only are options, too, where one stands out.
    """
    return with_columns(derivatives(problem, at, plant), hypothesis, columns, in_time)


def with_columns(
    about: Derivatives, hypothesis: Hypothesis, columns: Sequence[Column], in_time: bool = False
) -> QuadraticModel:
    """The quadratic model about a fit of `hypothesis` whose derivatives are known, with a secant for each column."""
    problem, at, count, linear = about.problem, about.at, about.nominal, about.linear
    free, q = at.free, at.q
    columns, moved, shifts = about.secants(columns)
    if in_time:
        columns, moved, shifts = _with_intervals(problem, at, linear, columns, moved, shifts)
    usable = np.any(moved != 0.0, axis=0)
    extended = (
        *free, *(FreeParameter(f"column {k}", 0.0, False, 1.0, 30.0, -np.inf, np.inf) for k in range(len(columns)))
    )  # fmt: skip
    linear = replace(
        linear,
        by_parameter=np.hstack([linear.by_parameter, moved]),
        ends_by_parameter=np.concatenate([linear.ends_by_parameter, shifts], axis=2),
    )
    everything = np.concatenate([q, np.zeros(len(columns))])
    matrix, gradient = normal_equations(problem, extended, everything, at.states, linear)
    system = matrix.eliminate(1e-9)
    size = len(extended)
    states = np.asarray(cho_solve_banded((system.factor, True), gradient[size:] / system.scale[size:]))
    scaled = gradient / system.scale
    slope = (scaled[:size] - system.carried.T @ scaled[size:]) * system.scale[:size]
    curvature = system.schur * np.outer(system.scale[:size], system.scale[:size])
    usable &= _own_share(curvature, count)[len(free) - count :] > ITS_OWN
    options, to_neutral = _options(hypothesis, at, count, columns, usable)
    constant = float(2.0 * slope @ to_neutral - to_neutral @ curvature @ to_neutral)
    lower, upper = _bounds(free, q, columns)
    slope = slope - curvature @ to_neutral
    scale = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    made_at = -to_neutral * scale
    return QuadraticModel(
        at, hypothesis, options, count,
        curvature / np.outer(scale, scale) + RIDGE * np.eye(size), slope / scale + RIDGE * made_at,
        (lower - to_neutral) * scale, (upper - to_neutral) * scale, scale,
        at.objective - float(scaled[size:] @ states) - constant + RIDGE * float(made_at @ made_at), to_neutral,
        states / system.scale[size:],
        system.carried * (system.scale[None, :size] / system.scale[size:, None]),
    )  # fmt: skip


def _own_share(curvature: Array, count: int) -> Array:
    """Of each column beyond the first `count`, the share of its energy that those cannot imitate."""
    energy = np.diag(curvature)[count:]
    if not count:
        return np.ones(len(energy))
    border = curvature[:count, count:]
    imitated = np.sum(border * np.linalg.solve(curvature[:count, :count], border), axis=0)
    return np.asarray(1.0 - imitated / np.where(energy > 0.0, energy, 1.0))


def _bounds(free: Sequence[FreeParameter], q: Array, columns: Sequence[Column]) -> tuple[Array, Array]:
    """How far each parameter may move, and the factors that each column may have."""
    longest = np.array([parameter.longest_move for parameter in free])
    lowest = np.array([parameter.coordinate(max(parameter.lower, -1e300)) for parameter in free])
    highest = np.array([parameter.coordinate(min(parameter.upper, 1e300)) for parameter in free])
    factors = np.array([column.factors() for column in columns]).reshape(-1, 2)
    lower = np.concatenate([np.clip(lowest - q, -longest, 0.0), factors[:, 0]])
    upper = np.concatenate([np.clip(highest - q, 0.0, longest), factors[:, 1]])
    return lower, upper


def _with_intervals(
    problem: Problem, at: Fit, linear: Linearised, columns: Sequence[Column], moved: Array, shifts: Array
) -> tuple[list[Column], Array, Array]:
    """The columns, and those of a few effects once more in the interval in which they explain most."""
    matrix, gradient = normal_equations(problem, at.free, at.q, at.states, linear)
    intervals = best_intervals(problem, at, linear, matrix.eliminate(1e-9), gradient, columns, moved, shifts)
    made, more, ends = list(columns), [moved], [shifts]
    for interval in intervals:
        column, own = restricted(
            problem, moved[:, [interval.column]], shifts[:, :, [interval.column]], interval.windows
        )
        made.append(in_interval(problem, columns[interval.column], interval.windows))
        more.append(column)
        ends.append(own)
    return made, np.hstack(more), np.concatenate(ends, axis=2)


def _options(
    hypothesis: Hypothesis, at: Fit, count: int, columns: Sequence[Column], usable: Array
) -> tuple[tuple[Option, ...], Array]:
    """What a set can be made of, and the members' moves to their neutral values."""
    free, q = at.free, at.q
    to_neutral = np.zeros(len(free) + len(columns))
    options = []
    for member in hypothesis.members:
        rows = dict(zip(member.effect.parameter_names(), member.effect.parameters, strict=True))
        instants = set(member.effect.acting_names())
        places = []
        for place, parameter in enumerate(free[count:], start=count):
            name = base_name(parameter.name)
            if name not in rows and name not in instants:
                continue
            places.append(place)
            if name in rows and rows[name].switches and not parameter.above and not parameter.logarithmic:
                nothing = at.values[rows[name].replaces] if rows[name].replaces else rows[name].nominal
                to_neutral[place] = parameter.coordinate(nothing) - q[place]
        options.append(Option(member, tuple(places)))
    groups: dict[tuple[str, int, bool], list[int]] = {}
    for k, column in enumerate(columns):
        if usable[k]:
            groups.setdefault((column.effect.id, column.alternative, column.limited), []).append(k)
    for places in groups.values():
        chosen = tuple(columns[k] for k in places)
        member = Member(chosen[0].effect.id, chosen[0].limited, chosen[0].variable, effect=chosen[0].effect)
        options.append(Option(member, tuple(len(free) + k for k in places), chosen))
    return tuple(options), to_neutral
