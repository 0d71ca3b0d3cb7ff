"""How a hypothesis is fitted: from the calibration or the nominal values, to its end, and from where its rivals stand.

Each of these initial guesses is there because a search without it stopped short of its optimum, and what stopped short
makes a rival look like a discovery.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eha_core.diagnosis.criteria import FAR_FROM_NOISE, NEAR_NOISE
from eha_core.diagnosis.effect_freedom import effect_freedom
from eha_core.diagnosis.hypotheses import Start
from eha_core.diagnosis.hypothesis import Hypothesis
from eha_core.diagnosis.screen import ScoreTest, one_each, scaled, screen
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit, fit_in_stages
from eha_core.identification.freedom import LATE, Free, coordinates
from eha_core.identification.per_recording import is_one_of
from eha_core.identification.problem import Problem
from eha_core.parameters import NOMINAL

SETTLED_LEADERS = 3

SETTLE_REACH = 300.0
"""The best few are fitted to their end, those at least that came within this of the best, or half of what it left
over."""

CROSSED = 3
"""How many of the leaders behind the best are fitted once more from where it stands."""

INSTANT_REACHES = (2.4, 1.2, 0.6, 0.3)
"""s; how far off an instant may be found to be before the rest is fitted to it again."""

INSTANT_SHIFTS = (-0.12, 0.12, -0.04, 0.04, -0.01, 0.01, -0.004, 0.004, -0.0015, 0.0015)
"""s; how far beside its optimum an instant is tried once more."""

OUT_OF_REACH = 200.0
"""A hypothesis that cannot come within this of the best objective so far is not fitted to its end."""

WITH_DYNAMICS_AS_GIVEN = 2
DYNAMICS_HELD_SHARE = 0.25
BENT = 0.02
"""Where the calibration moved the valve's dynamics by this share, a delay or a lag may be what it imitated: so many
hypotheses are tried from the dynamics as given, too, where their predicted gain is this share of what others need."""

NOMINAL_NAMES = frozenset(row.name for row in NOMINAL)

Progress = Callable[[str], None]
Found = dict[Hypothesis, Fit]
"""The best fit so far of each hypothesis."""


def with_dynamics_as_given(problem: Problem, calibrated: Fit) -> Fit | None:
    """The calibration with the valve's dynamics at their nominal values; None where it hardly moved them."""
    late = {one.name: one.reference for one in calibrated.free if is_one_of(one.name, LATE)}
    if all(abs(calibrated.values[name] / given - 1.0) < BENT for name, given in late.items()):
        return None
    rest = [one for one in calibrated.free if one.name not in late]
    held = fit(problem, {**calibrated.values, **late}, rest, calibrated.states, iterations=5)
    return set_free(held, calibrated.free)


def as_given(problem: Problem, calibrated: Fit) -> Fit:
    """The calibration with every nominal parameter back at its nominal value, only the windows' starts fitted again."""
    given = {one.name: one.reference for one in calibrated.free if is_one_of(one.name, NOMINAL_NAMES)}
    return set_free(fit(problem, {**calibrated.values, **given}, (), calibrated.states, iterations=5), calibrated.free)


def set_free(held: Fit, free: tuple[Free, ...]) -> Fit:
    """A fit as a point at which all of `free` may move again."""
    return replace(held, free=free, q=coordinates(free, held.values))


def keep_better(found: Found, hypothesis: Hypothesis, result: Fit) -> None:
    """Add a fitted hypothesis, or let it take the place of a worse fit of the same one."""
    if hypothesis not in found or result.objective < found[hypothesis].objective:
        found[hypothesis] = result


def best_first(found: Found) -> list[Hypothesis]:
    """The hypotheses in the order of their objectives, the lowest first."""
    return sorted(found, key=lambda one: found[one].objective)


@dataclass(frozen=True)
class Attempt:
    """An effect that is worth a refit, the fit that it is to be added to, and whether the search begins at the nominal
    values."""

    base: Fit
    score_test: ScoreTest
    from_nominal: bool


def attempt_on(base: Fit, score_test: ScoreTest) -> Attempt:
    """An attempt from where a fit stands; from the nominal values where that is far off, which has bent its parameters
    to imitate what is missing."""
    return Attempt(base, score_test, base.data > FAR_FROM_NOISE * base.count)


def attempts(
    problem: Problem,
    base: Fit,
    initial_guesses: Sequence[Start],
    score_tests: Sequence[ScoreTest],
    most: int,
    least: float,
) -> tuple[Attempt, ...]:
    """What to try on top of a fit: the effects of its own largest predicted gains, then those of the fit with the
    dynamics as given.

    What is predicted to gain too little is left out; where the dynamics would have to bend back first, that says less.
    A fit that is far off has bent its parameters, and what is missing shows against the nominal ones first.
    """
    leading = one_each(score_tests, most)
    if base.data > FAR_FROM_NOISE * base.count:
        straight = one_each(screen(problem, as_given(problem, base), initial_guesses), most)
        leading = one_each((*straight, *leading), 2 * most)
    chosen = [attempt_on(base, score_test) for score_test in leading if score_test.gain > least]
    dynamics_held = with_dynamics_as_given(problem, base)
    if dynamics_held is None:
        return tuple(chosen)
    # what the dynamics could imitate shows only while they are held
    held = set_free(dynamics_held, tuple(one for one in base.free if not is_one_of(one.name, LATE)))
    again = one_each(screen(problem, held, initial_guesses), WITH_DYNAMICS_AS_GIVEN)
    known = {one.score_test.start.effect.id for one in chosen if one.from_nominal}
    from_nominal = [Attempt(dynamics_held, one, True) for one in again if one.start.effect.id not in known]
    return (*chosen, *(one for one in from_nominal if one.score_test.gain > DYNAMICS_HELD_SHARE * least))


def refit_with(problem: Problem, attempt: Attempt, best: float) -> Fit:
    """Fit the effect, giving up when it cannot come near the `best` objective so far."""
    base, score_test = attempt.base, attempt.score_test
    effect = score_test.start.effect
    if attempt.from_nominal:
        untouched = {one.name: one.reference for one in base.free if is_one_of(one.name, NOMINAL_NAMES)}
        values = {**base.values, **untouched, **score_test.start.values}
        free = _with_effect(base.free, effect, values)
        return fit_in_stages(problem, values, free, give_up_above=best + OUT_OF_REACH)
    values = {**base.values, **scaled(score_test)}
    free = _with_effect(base.free, effect, values)
    return fit(problem, values, free, base.states, iterations=25, give_up_above=best + OUT_OF_REACH)


def _with_effect(free: tuple[Free, ...], effect: Effect, values: Mapping[str, float]) -> tuple[Free, ...]:
    extra = effect_freedom(effect, values)
    return (*(one for one in free if one.name not in {own.name for own in extra}), *extra)


def settle(problem: Problem, found: Found, progress: Progress = lambda _: None) -> Found:
    """The leaders fitted to their end: with derivatives at the full step, and from more than one start where it may
    matter.

    A search from a calibration that is far off can leave the nominal parameters in a valley of their own.
    """
    exact = replace(problem, slope_step=problem.shooting.step_size)
    best = np.inf
    settled = dict(found)
    for hypothesis in best_first(found)[:SETTLED_LEADERS]:
        result = found[hypothesis]
        if result.objective > best + 0.5 * max(best - problem.count(), 0.0) + SETTLE_REACH:
            continue
        progress(f"settling {' and '.join(hypothesis.ids)}")
        result = fit(exact, result.values, result.free, result.states, iterations=30)
        if result.data > NEAR_NOISE * result.count:
            untouched = {one.name: one.reference for one in result.free if is_one_of(one.name, NOMINAL_NAMES)}
            again = fit(problem, {**result.values, **untouched}, result.free, None, iterations=15)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
        dynamics_held = with_dynamics_as_given(problem, result)
        if dynamics_held is not None:
            again = fit(problem, dynamics_held.values, result.free, dynamics_held.states, iterations=10)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
        result = _other_instants(problem, exact, result)
        best = min(best, result.objective)
        settled[hypothesis] = result
    return settled


def cross(problem: Problem, found: Found) -> Found:
    """The leaders fitted once more from where the best of them has what all models share, and the windows' starts.

    Where friction sticks, the objective is rugged: a law can rest far above its own optimum, and a richer one that
    holds it as a special case would win for that.
    """
    if len(found) < 2:
        return found
    leading, *others = best_first(found)
    best = found[leading]
    crossed = dict(found)
    for hypothesis in others[:CROSSED]:
        result = found[hypothesis]
        both = (one.name for one in result.free if one.name in best.values)
        shared = {name: best.values[name] for name in both if is_one_of(name, NOMINAL_NAMES)}
        shared |= _same_interval(hypothesis, leading, best.values)
        kindred = _of_the_same_kind(hypothesis.effects, leading.effects, best.values)
        for own in (kindred, {}) if kindred else ({},):
            values, worse = {**result.values, **shared, **own}, best.objective + OUT_OF_REACH
            again = fit(problem, values, result.free, best.states, iterations=15, give_up_above=worse)
            keep_better(crossed, hypothesis, again)
    return _to_their_ends(problem, crossed)


def _to_their_ends(problem: Problem, found: Found) -> Found:
    """What comes near the best fitted until it gains nothing, with derivatives at the full step: a rival that stopped a
    little short would seem to be told apart."""
    exact = replace(problem, slope_step=problem.shooting.step_size)
    best = min(result.objective for result in found.values())
    near = {one: at for one, at in found.items() if best < at.objective < best + OUT_OF_REACH}
    ended = {one: fit(exact, at.values, at.free, at.states, iterations=30) for one, at in near.items()}
    return found | {one: at for one, at in ended.items() if at.objective < found[one].objective}


def _same_interval(hypothesis: Hypothesis, other: Hypothesis, values: Mapping[str, float]) -> dict[str, float]:
    """The interval in which the other's effect acts, for this one's, where each has one that acts for a while."""
    if len(hypothesis.limited) != 1 or len(other.limited) != 1:
        return {}
    names = (one.limited[0].effect.acting_names() for one in (hypothesis, other))
    return {own: values[theirs] for own, theirs in zip(*names, strict=True)}


def _of_the_same_kind(
    effects: Sequence[Effect], others: Sequence[Effect], values: Mapping[str, float]
) -> dict[str, float]:
    """What the other effects' laws call by the same name as laws of the same kind among these: force, static_force."""
    return {
        own: values[theirs]
        for effect in effects
        for other in others
        if effect.kind and effect.kind == other.kind and effect is not other
        for own in effect.parameter_names()
        for theirs in other.parameter_names()
        if own.rsplit(".", 1)[1] == theirs.rsplit(".", 1)[1]
    }


def _other_instants(problem: Problem, exact: Problem, result: Fit) -> Fit:
    """An instant that a fit moves can rest beside the right one, by far or by a little: try its surroundings."""
    for one in result.free:
        if one.resolution == 0.0:
            continue
        if result.data > NEAR_NOISE * result.count:
            result = _far_instant(problem, exact, result, one)
        for shift in INSTANT_SHIFTS:
            moved = {**result.values, one.name: result.values[one.name] + shift}
            again = fit(problem, moved, result.free, result.states, iterations=6, give_up_above=result.objective)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
    return result


def _far_instant(problem: Problem, exact: Problem, result: Fit, one: Free) -> Fit:
    """The instant looked for far and wide with all else as it stands: between a wrong one and the right one the windows
    alone are wrong."""
    best, at = result.objective, result.values[one.name]
    there = at
    for reach in INSTANT_REACHES:
        for instant in (there - reach, there + reach):
            moved = {**result.values, one.name: min(max(instant, one.lower), one.upper)}
            again = fit(problem, moved, (), result.states, iterations=3)
            if again.objective < best:
                best, at = again.objective, moved[one.name]
        there = at
    if best == result.objective:
        return result
    moved = {**result.values, one.name: at}
    found = fit(exact, moved, result.free, result.states, iterations=12)
    return found if found.objective < result.objective else result


def refit_nominal(problem: Problem, calibrated: Fit, others: Sequence[Fit]) -> Fit:
    """The nominal model fitted once more from the best hypothesis' nominal values.

    A nominal fit that stopped in a flat valley would make any hypothesis that left it look like a discovery.
    """
    if not others:
        return calibrated
    best = min(others, key=lambda one: one.objective)
    names = {one.name for one in calibrated.free}
    values = {name: best.values[name] if name in names else value for name, value in calibrated.values.items()}
    again = fit(problem, values, calibrated.free, best.states)
    return again if again.objective < calibrated.objective else calibrated
