"""Which single effects are refitted, and from which values: those of the fit, or the nominal ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eha_core.diagnosis.criteria import FAR_FROM_NOISE
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.search.found import OUT_OF_REACH
from eha_core.diagnosis.search.initial_guesses import InitialGuess
from eha_core.diagnosis.search.nominal_start import (
    HELD_SHARE,
    TRIED_WITH_DYNAMICS_HELD,
    at_nominal_values,
    nominal_values_of,
    set_free,
    with_dynamics_held,
)
from eha_core.diagnosis.search.screening import ScoreTest, one_each, scaled, screen
from eha_core.identification.fit import Fit, fit, fit_in_stages
from eha_core.identification.free_parameters import LATE
from eha_core.identification.per_recording import is_one_of
from eha_core.identification.problem import Problem


@dataclass(frozen=True)
class PlannedRefit:
    """An effect that is worth a refit, the fit it is added to, and whether the refit begins at the nominal values."""

    base: Fit
    score_test: ScoreTest
    from_nominal: bool


def refit_on(base: Fit, score_test: ScoreTest) -> PlannedRefit:
    """A refit from the values of `base`; from the nominal values where that is far from noise, as its parameters are
    biased by what is missing."""
    return PlannedRefit(base, score_test, base.data > FAR_FROM_NOISE * base.count)


def planned_refits(
    problem: Problem,
    base: Fit,
    initial_guesses: Sequence[InitialGuess],
    score_tests: Sequence[ScoreTest],
    most: int,
    least: float,
) -> tuple[PlannedRefit, ...]:
    """What to try on top of a fit: the effects of its own largest predicted gains, then those of the fit with the
    dynamics held.

    What is predicted to gain too little is left out; where the dynamics would have to come back first, that says less.
    The parameters of a fit that is far from noise are biased; what is missing shows against the nominal ones first.
    """
    leading = one_each(score_tests, most)
    if base.data > FAR_FROM_NOISE * base.count:
        straight = one_each(screen(problem, at_nominal_values(problem, base), initial_guesses), most)
        leading = one_each((*straight, *leading), 2 * most)
    chosen = [refit_on(base, score_test) for score_test in leading if score_test.gain > least]
    dynamics_held = with_dynamics_held(problem, base)
    if dynamics_held is None:
        return tuple(chosen)
    # what the dynamics could imitate shows only while they are held
    held = set_free(dynamics_held, tuple(parameter for parameter in base.free if not is_one_of(parameter.name, LATE)))
    again = one_each(screen(problem, held, initial_guesses), TRIED_WITH_DYNAMICS_HELD)
    known = {planned.score_test.guess.effect.id for planned in chosen if planned.from_nominal}
    from_nominal = [
        PlannedRefit(dynamics_held, score_test, True) for score_test in again if score_test.guess.effect.id not in known
    ]
    return (*chosen, *(planned for planned in from_nominal if planned.score_test.gain > HELD_SHARE * least))


def refit_with(problem: Problem, planned: PlannedRefit, best: float) -> Fit:
    """Fit the effect, giving up when it cannot come near the `best` objective so far."""
    base, score_test = planned.base, planned.score_test
    effect = score_test.guess.effect
    if planned.from_nominal:
        values = {**base.values, **nominal_values_of(base.free), **score_test.guess.values}
        free = with_effects(base.free, [effect], values)
        return fit_in_stages(problem, values, free, give_up_above=best + OUT_OF_REACH)
    values = {**base.values, **scaled(score_test)}
    free = with_effects(base.free, [effect], values)
    return fit(problem, values, free, base.states, iterations=25, give_up_above=best + OUT_OF_REACH)
