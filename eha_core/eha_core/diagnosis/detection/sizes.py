"""The smallest detectable size of each effect, by a few secant steps.

An effect's response is seldom proportional to its size, so it is simulated at the size itself.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from math import exp, inf, log

import numpy as np
from numpy.typing import NDArray

from eha_core.diagnosis.criteria import chance_gain
from eha_core.diagnosis.detection.power import energy_needed, required_gain
from eha_core.diagnosis.detection.responses import FittedModel, responses
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.search.columns import SIZES, Column, applicable_effects, columns_of
from eha_core.diagnosis.search.finish import left_by_forms, predicted_costs, required_of
from eha_core.effects import Effect

Array = NDArray[np.float64]

PASSES = 10
"""Most secant steps; most sizes need four."""

CLOSE = 0.04
"""Relative tolerance of a response's energy: two per cent of a size."""

STEEPEST, FLATTEST = 6.0, 0.5
"""Bounds of the assumed power of the energy in the size: 2 where the response is linear; that of a dead band or a stop,
which only large motions reach, grows faster."""

FARTHEST = 7.0
"""Largest step between two guesses, as the logarithm of a factor: a thousand."""

LEAST = -2.0 * FARTHEST
"""Logarithm of the least factor that is tried: a response that is large enough at a millionth of the usual size is not
of the size. An onset of leakage that takes the place of one which was moved on purpose shows by its instant."""


@dataclass(frozen=True)
class Trial:
    """A column in one direction, at some factor of its size, and what the search asks of its effect.

    `sign`: of the size, where either may be. `parameters`: how many a fit of the effect moves. `gain`: chi^2 required.
    `energy`: what its response needs for that to be found with CERTAINTY. `most`: the largest factor that the catalogue
    allows.
    """

    column: Column
    sign: float
    parameters: int
    gain: float
    energy: float
    most: float

    def at(self, factor: float) -> Column:
        """The column with its size multiplied by `factor`."""
        return replace(self.column, values=self.column.sized(self.sign * factor))

    @property
    def shape(self) -> dict[str, float]:
        """The values of the effect that are not its sizes, by full name."""
        rows = dict(zip(self.column.effect.parameter_names(), self.column.effect.parameters, strict=True))
        return {name: value for name, value in self.column.values.items() if name in rows and not rows[name].switches}


def trials(at: FittedModel, without: Collection[str] = ()) -> list[Trial]:
    """One trial for each independent size of each effect in each of the shapes that the search tries, and two where the
    size may have either sign: the nominal parameters' bounds make them differ.

    No trial of effects `without`, of what is in the set already, and of other forms of that; nor of a size that differs
    between recordings, which none of them would show alone.
    """
    marked = at.pool.problem.shooting.per_recording
    found = dict[tuple[object, ...], Trial]()
    for effect, of_a_member in required_of_one_more(at).items():
        if effect.id in without or set(marked) & set(effect.parameter_names()):
            continue
        for column in columns_of(effect, at.scales):
            if column.most != SIZES[1.0]:
                continue  # the same guess at another share of its size
            parameters = len(free_effect_parameters(effect, column.values))
            gain = required_gain(of_a_member, parameters, at.fit.count, at.variance)
            energy = at.variance * energy_needed(gain / at.variance, parameters)
            least, most = replace(column, most=inf).factors()
            for sign, farthest in ((1.0, most), (-1.0, -least)):
                if farthest > 0.0:
                    trial = Trial(column, sign, parameters, gain, energy, farthest)
                    found.setdefault((column.sizes, sign, *sorted(trial.shape.items())), trial)
    return list(found.values())


def required_of_one_more(at: FittedModel) -> dict[Effect, float]:
    """Chi^2 that the search requires of each effect that could be added to the set.

    The allowance for the form of other laws counts in full: whether it is limited by the residual depends on the noise.
    """
    addable = [effect for effect in applicable_effects(at.observations) if at.hypothesis.admits(effect)]
    costs = predicted_costs(at.pool, at.hypothesis, at.fit) if at.hypothesis.members else {}
    found = {}
    for member in (Member(effect.id, effect=effect) for effect in addable):
        together = {**costs, member: inf}
        by_chance = chance_gain(at.fit.count, at.variance)
        beside_forms = by_chance + left_by_forms(at.pool, member, together, at.fit)
        found[member.effect] = max(beside_forms, required_of(at.pool, member, together, at.fit))
    return found


def smallest(at: FittedModel, tried: Sequence[Trial]) -> Array:
    """Of each trial, the factor on its size at which its response has the energy that is asked for; inf where none up
    to the catalogue's bound has, 0 where the response is no smaller for a smaller size. Ten passes, each of one secant
    for every trial that is not there yet."""
    seen: list[list[Point]] = [[] for _ in tried]
    guesses = [min(0.0, log(trial.most)) for trial in tried]
    for _ in range(PASSES):
        places = [k for k, trial in enumerate(tried) if not _is_done(seen[k], trial)]
        if not places:
            break
        guesses = [next_guess(points, log(trial.energy), log(trial.most))
                   for points, trial in zip(seen, tried, strict=True)]  # fmt: skip
        found = responses(at, [tried[k].at(exp(guesses[k])) for k in places])
        for place, k in enumerate(places):
            energy = found.left(place) if found.usable[place] else 0.0
            seen[k].append((guesses[k], log(energy) if energy > 0.0 else -inf))
    return np.array([_reached(points, trial) for points, trial in zip(seen, tried, strict=True)])


Point = tuple[float, float]
"""Logarithms of a factor, and of the energy of the response there."""


def next_guess(seen: Sequence[Point], wanted: float, highest: float) -> float:
    """Where the energy's logarithm may be `wanted`, from where it was seen: along the power that the last two points
    show, or in the middle of the bracket."""
    if not seen:
        return min(0.0, highest)
    here, value = seen[-1]
    power = 2.0
    if len(seen) > 1 and min(value, seen[-2][1]) > -inf and here != seen[-2][0]:
        power = min(max((value - seen[-2][1]) / (here - seen[-2][0]), FLATTEST), STEEPEST)
    guess = here + min(max((wanted - value) / power, -FARTHEST), FARTHEST)
    lower = max((x for x, y in seen if y < wanted), default=-inf)
    upper = min((x for x, y in seen if y >= wanted), default=inf)
    if lower < guess < upper:
        return min(guess, highest)
    return 0.5 * (lower + upper) if upper < inf else highest


def _is_done(seen: Sequence[Point], trial: Trial) -> bool:
    return bool(seen) and (
        abs(seen[-1][1] - log(trial.energy)) < CLOSE or _is_at_the_end(seen, trial) or seen[-1][0] <= LEAST
    )


def _is_at_the_end(seen: Sequence[Point], trial: Trial) -> bool:
    """Whether even the largest size in the catalogue's bounds is not detectable."""
    return seen[-1][0] >= log(trial.most) and seen[-1][1] < log(trial.energy)


def _reached(seen: Sequence[Point], trial: Trial) -> float:
    """The closest factor from above, because a stated size has to be detectable."""
    enough = [x for x, y in seen if y > log(trial.energy) - CLOSE]
    least = min(enough, default=inf)
    return 0.0 if least <= LEAST else exp(least)
