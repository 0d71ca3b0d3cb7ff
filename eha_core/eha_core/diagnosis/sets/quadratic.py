"""The quadratic model of chi^2 about a fitted set: every other set of effects is a point in it.

One Jacobian of the nominal parameters, the windows' states and the members' parameters, and one secant for each column
of the catalogue. States and nominal parameters are eliminated from the Gram matrix; what is left is small, and a set
costs microseconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_solve_banded

from eha_core.diagnosis.hypothesis import Hypothesis, Member, neutral
from eha_core.diagnosis.sets.columns import Column
from eha_core.diagnosis.sets.intervals import best_intervals, in_interval, restricted
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter, coordinates
from eha_core.identification.numbers import Array, Integers
from eha_core.identification.per_recording import base_name, in_each
from eha_core.identification.problem import Linearised, Problem, changes, linearise, normal_equations

RIDGE = 1e-7
"""Of the unit diagonal: columns that are one and the same to seven digits share a coefficient."""

ITS_OWN = 1e-6
"""Share of a column's energy that the nominal parameters must not be able to imitate for it to be an option."""

LARGEST, SMALLEST = 10.0, 0.03
"""Factors on a guess's size within which the linear model is believed for the start of a fit."""


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
    """Chi^2 about a fitted set, over the coordinates of the members and the columns of what could be added.

    Attributes:
        options: what a set can be made of.
        matrix: (columns, columns) the curvature, scaled to a unit diagonal, with all else free.
        gradient: (columns,) at the empty set.
        one_way: (columns,) 1 where the coefficient cannot be negative, -1 where it cannot be positive, 0 else.
        empty: predicted objective of the nominal equations alone.
    """

    at: Fit
    hypothesis: Hypothesis
    options: tuple[Option, ...]
    matrix: Array
    gradient: Array
    one_way: Integers
    empty: float
    scale: Array
    to_neutral: Array
    nominal_places: Integers
    nominal_move: Array
    nominal_by_column: Array
    states_move: Array
    carried: Array

    def coefficients(self, chosen: Sequence[Option]) -> Array:
        """The coefficients of a set's columns, in their order (of its options), unscaled."""
        places = [place for option in chosen for place in option.places]
        block = self.matrix[np.ix_(places, places)]
        return np.asarray(np.linalg.solve(block, self.gradient[places]) / self.scale[places])

    def start(self, chosen: Sequence[Option], share: float = 1.0) -> tuple[dict[str, float], Array]:
        """Values and states at a `share` of the way to a set's predicted optimum; what is not in the set is out."""
        free = self.at.free
        moves = self.to_neutral.copy()
        places = [place for option in chosen for place in option.places]
        found = self.coefficients(chosen)
        moves[places] += found
        moves *= share
        nominal = share * self.nominal_move - self.nominal_by_column @ moves
        states = self.at.states + (share * self.states_move - self.carried @ np.concatenate([nominal, moves])).reshape(
            self.at.states.shape
        )
        count = len(self.nominal_places)
        q = self.at.q.copy()
        q[:count] += nominal
        q[count:] += moves[: len(q) - count]
        longest = np.array([parameter.longest_move for parameter in free])
        q = self.at.q + np.clip(q - self.at.q, -longest, longest)
        values = dict(self.at.values)
        for parameter, at in zip(free, q, strict=True):
            values[parameter.name] = parameter.value(float(at))
        for parameter in free:
            if parameter.above:
                values[parameter.name] = values[parameter.above] * (1.0 + values[parameter.name])
        return with_options(
            self.hypothesis, values, chosen, dict(zip(places, (share * found).tolist(), strict=True))
        ), states


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
            sized = column.sized(float(np.sign(factor) or 1.0) * float(np.clip(abs(factor), SMALLEST, LARGEST)))
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
    shooting = problem.shooting
    nominal, _ = in_each(plant, at.values, shooting.per_recording, len(shooting.first_windows))
    own, _ = in_each(at.free, at.values, shooting.per_recording, len(shooting.first_windows))
    names = {parameter.name for parameter in nominal}
    free = (*nominal, *(parameter for parameter in own if parameter.name not in names))
    q = coordinates(free, at.values)
    at = replace(at, free=free, q=q)
    linear = linearise(problem, at.values, free, q, at.states)
    moved, shifts = changes(
        problem, (at.values, at.states), [({**at.values, **column.values}, at.states) for column in columns]
    )
    usable = np.all(np.isfinite(moved), axis=0) & np.any(moved != 0.0, axis=0)
    moved[:, ~usable], shifts[:, :, ~usable] = 0.0, 0.0
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
    towards = (scaled[:size] - system.carried.T @ scaled[size:]) * system.scale[:size]
    curvature = system.schur * np.outer(system.scale[:size], system.scale[:size])
    count = len(nominal)
    first, rest = np.arange(count), np.arange(count, size)
    block = curvature[np.ix_(first, first)]
    solved = (
        np.linalg.solve(block, np.column_stack([towards[first], curvature[np.ix_(first, rest)]]))
        if count
        else (np.zeros((0, 1 + len(rest))))
    )
    reduced = curvature[np.ix_(rest, rest)] - curvature[np.ix_(rest, first)] @ solved[:, 1:]
    slope = towards[rest] - curvature[np.ix_(rest, first)] @ solved[:, 0]
    # what the plant's own parameters can do as well is no option
    told = np.diag(reduced) > ITS_OWN * np.diag(curvature)[rest]
    usable &= told[len(free) - count :]
    gained = float(scaled[size:] @ states) + float(towards[first] @ solved[:, 0])
    options, one_way, to_neutral = _options(hypothesis, free, q, count, columns, usable)
    constant = float(2.0 * slope @ to_neutral - to_neutral @ reduced @ to_neutral)
    slope = slope - reduced @ to_neutral
    scale = np.sqrt(np.maximum(np.diag(reduced), 1e-300))
    return QuadraticModel(
        at, hypothesis, options, reduced / np.outer(scale, scale) + RIDGE * np.eye(len(rest)), slope / scale, one_way,
        at.objective - gained - constant, scale, to_neutral, first, solved[:, 0], solved[:, 1:],
        states / system.scale[size:],
        system.carried * (system.scale[None, :size] / system.scale[size:, None]),
    )  # fmt: skip


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
    hypothesis: Hypothesis,
    free: Sequence[FreeParameter],
    q: Array,
    count: int,
    columns: Sequence[Column],
    usable: Array,
) -> tuple[tuple[Option, ...], Integers, Array]:
    """What a set can be made of, the signs that coefficients may have, and the members' moves to their neutral
    values."""
    size = len(free) - count + len(columns)
    one_way, to_neutral = np.zeros(size, dtype=np.int64), np.zeros(size)
    options = []
    for member in hypothesis.members:
        rows = dict(zip(member.effect.parameter_names(), member.effect.parameters, strict=True))
        instants = set(member.effect.acting_names())
        places = []
        for place, parameter in enumerate(free[count:]):
            name = base_name(parameter.name)
            if name not in rows and name not in instants:
                continue
            places.append(place)
            if name in rows and rows[name].switches and not parameter.above and not parameter.logarithmic:
                to_neutral[place] = parameter.coordinate(rows[name].nominal) - q[count + place]
        options.append(Option(member, tuple(places)))
    groups: dict[tuple[str, int, bool], list[int]] = {}
    for k, column in enumerate(columns):
        if usable[k]:
            groups.setdefault((column.effect.id, column.alternative, column.limited), []).append(k)
            one_way[len(free) - count + k] = int(column.one_way)
    for places in groups.values():
        chosen = tuple(columns[k] for k in places)
        member = Member(chosen[0].effect.id, chosen[0].limited, chosen[0].variable, effect=chosen[0].effect)
        options.append(Option(member, tuple(len(free) - count + k for k in places), chosen))
    return tuple(options), one_way, to_neutral
