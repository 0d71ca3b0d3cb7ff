"""Effects that act over an interval: what a model with its effects always on, or never, cannot explain.

Windows in a row in which an effect is predicted to gain far more than over the whole record tell where to look. The
nominal equations, with the effects that are known to act always, are then fitted to the rest of the record alone, which
has not biased their parameters, and the catalogue is screened once more from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import log

import numpy as np

from eha_core.diagnosis.criteria import NEAR_NOISE, OUTSTANDING, UNTOUCHED
from eha_core.diagnosis.effect_parameters import free_effect_parameters, free_instants
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.search.converge import converge
from eha_core.diagnosis.search.found import OUT_OF_REACH, Found, Progress, best_first
from eha_core.diagnosis.search.initial_guesses import InitialGuess
from eha_core.diagnosis.search.screening import ScoreTest, scaled, screen_in_time
from eha_core.diagnosis.search.warm_start import warm_start
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit, fit_in_stages, refit_states
from eha_core.identification.numbers import Array
from eha_core.identification.parallel import each
from eha_core.identification.problem import Problem

SPACINGS = (0.25, 0.0625, 0.015, 0.004)
ABREAST = 4
"""s; an instant is tried so many times to either side of where it is taken to be, ever more closely. The search is by
trial, for an instant that is wrong by more than a moment shows no slope that leads to the right one."""

SHARPER = 0.1
"""Share of the usual span over which an instant's derivative is taken once it is known closely."""

TOUCHING = 1e-6
"""s; a window that begins where a span ends touches it."""

OUTSIDE = 12
"""Iterations in which a set comes to explain the rest of the record, if it does."""

TRIED = 4
"""How many effects are fitted with the span in which they act."""


def time_limited_effects(
    problem: Problem,
    calibrated: Fit,
    initial_guesses: Sequence[InitialGuess],
    score_tests: Sequence[ScoreTest],
    least: float,
    progress: Progress = lambda _: None,
) -> Found:
    """Single effects with the span in which they act, fitted to their end; none where the predicted gains of the
    record's windows show no such thing, or less than `least`."""
    windows = _outstanding(score_tests, least + 2.0 * log(problem.count()), OUTSTANDING)
    if windows is None:
        return {}
    rest = _rest(problem, windows)
    untouched = {parameter.name: parameter.reference for parameter in calibrated.free}
    outside = calibrated
    if len(rest.windows) > 1:
        fitted = fit_in_stages(rest, {**calibrated.values, **untouched}, calibrated.free)
        outside = _at_the_whole(problem, fitted)
    progress("looking when an effect acts")
    found = _fitted(problem, NOTHING, outside, initial_guesses, calibrated.objective, progress)
    warm_started = warm_start(problem, converge(problem, found, progress))
    sharpened = {hypothesis: _sharpened(problem, result) for hypothesis, result in warm_started.items()}
    # with instants that are off by half a millisecond a law would seem to explain less than a richer form of it
    return warm_start(problem, sharpened)


def time_limited_beside(
    problem: Problem,
    base: Hypothesis,
    fitted: Fit,
    initial_guesses: Sequence[InitialGuess],
    score_tests: Sequence[ScoreTest],
    least: float,
    progress: Progress = lambda _: None,
) -> Found:
    """The set `base`, of which `fitted` is a fit, with one effect more that acts over an interval; none where the
    predicted gains show no such thing, or the set does not explain the rest of the record far better than the whole.

    Beside an effect that is still missing no gain stands out as it does alone; what does is that the rest is explained.
    """
    more_is_missing = fitted.data > NEAR_NOISE * fitted.count
    windows = _outstanding(score_tests, least + 2.0 * log(problem.count()), 1.0 if more_is_missing else OUTSTANDING)
    if windows is None:
        return {}
    rest = _rest(problem, windows)
    if len(rest.windows) < 2:
        return {}
    progress("looking when an effect acts")
    outside = fit(rest, fitted.values, fitted.free, fitted.states, iterations=OUTSIDE)
    if outside.data / outside.count > max(NEAR_NOISE, 1.0 + UNTOUCHED * (fitted.data / fitted.count - 1.0)):
        return {}
    outside = _at_the_whole(problem, outside)
    found = _fitted(problem, base, outside, initial_guesses, fitted.objective, progress)
    return {**found, **{leading: _sharpened(problem, found[leading]) for leading in best_first(found)[:1]}}


def _outstanding(score_tests: Sequence[ScoreTest], least: float, times: float) -> tuple[int, int] | None:
    """The windows in a row in which an effect is predicted to gain most; None where that is less than `least`, or than
    so many times what any effect gains that always acts."""
    always = max([0.0, *(score_test.gain for score_test in score_tests if score_test.windows is None)])
    best = max(
        (score_test for score_test in score_tests if score_test.windows is not None),
        key=lambda score_test: score_test.gain,
        default=None,
    )
    return None if best is None or best.gain < max(least, times * always) else best.windows


def _fitted(
    problem: Problem, base: Hypothesis, outside: Fit, initial_guesses: Sequence[InitialGuess], reached: float,
    progress: Progress,
) -> Found:  # fmt: skip
    """What is predicted to gain most in windows in a row, added to `base` and fitted with the span in which it acts.
    `outside`: the base as the rest of the record has it; `reached`: its objective over the whole."""
    chosen = _best_of_each(screen_in_time(problem, outside, initial_guesses))
    if not chosen:
        return {}
    begun = [_of_fixed_span(problem, outside, score_test) for score_test in chosen]
    nearest = min(range(len(begun)), key=lambda place: begun[place].objective)
    instants = _located(problem, begun[nearest], chosen[nearest].guess.effect)
    found: Found = {}
    for score_test, beginning in zip(chosen, begun, strict=True):
        effect = score_test.guess.effect
        progress(f"refitting with {effect.id} over an interval")
        values = {**beginning.values, **instants.of(effect)}
        own = (*free_effect_parameters(effect, values), *free_instants(instants.of(effect), instants.bounds))
        result = fit(
            problem, values, (*outside.free, *own), instants.states,
            iterations=25, give_up_above=reached + OUT_OF_REACH,
        )  # fmt: skip
        reached = min(reached, result.objective)
        found[base.with_effects([effect], limited=True)] = result
    return found


def _rest(problem: Problem, windows: tuple[int, int]) -> Problem:
    """The problem of all windows but these, and those that touch them."""
    begin, end = _span_of(problem, windows)
    local = problem.shooting.local_edges
    # a window that only touches the span is inside, too
    inside = np.flatnonzero((local[:, 1] >= begin - TOUCHING) & (local[:, 0] <= end + TOUCHING))
    return replace(problem, windows=np.setdiff1d(problem.windows, inside))


def _at_the_whole(problem: Problem, of_the_rest: Fit) -> Fit:
    """A model that was fitted to some windows with every window's start fitted under it."""
    started = refit_states(problem, of_the_rest)
    return fit(problem, of_the_rest.values, of_the_rest.free, started.states, iterations=0)


def _span_of(problem: Problem, windows: tuple[int, int]) -> tuple[float, float]:
    """When these windows in a row begin and end [s] in their recording."""
    local = problem.shooting.local_edges
    return float(local[windows[0], 0]), float(local[windows[1] - 1, 1])


def _best_of_each(score_tests: Sequence[ScoreTest]) -> list[ScoreTest]:
    """The best of each effect; none of one that has an instant of its own at which it sets in."""
    best: dict[str, ScoreTest] = {}
    for score_test in score_tests:
        sets_in = any(row.relative_to == "time" for row in score_test.guess.effect.parameters)
        if score_test.windows is not None and not sets_in:
            best.setdefault(score_test.guess.effect.id, score_test)
    return list(best.values())[:TRIED]


def _of_fixed_span(problem: Problem, base: Fit, score_test: ScoreTest) -> Fit:
    """The effect's own parameters fitted, in the span that the windows tell, and nothing else."""
    assert score_test.windows is not None
    effect = score_test.guess.effect
    span = dict(zip(effect.acting_names(), _span_of(problem, score_test.windows), strict=True))
    values = {**base.values, **scaled(score_test), **span}
    return fit(problem, values, free_effect_parameters(effect, values), base.states, iterations=8)


@dataclass(frozen=True)
class _Instants:
    """When an effect begins and ceases to act [s], between which bounds, and the windows' starts under that."""

    span: tuple[float, ...]
    bounds: tuple[tuple[float, float], ...]
    states: Array

    def of(self, effect: Effect) -> dict[str, float]:
        """The instants as those of this effect."""
        return dict(zip(effect.acting_names(), self.span, strict=True))


def _located(problem: Problem, result: Fit, effect: Effect) -> _Instants:
    """Move either instant by trial, with the windows' starts alone free."""
    longest = float(np.max(problem.shooting.local_edges))
    reach, names = ABREAST * SPACINGS[0], effect.acting_names()
    around = [result.values[name] for name in names]
    bounds = tuple((max(at - reach, 0.0), min(at + reach, longest)) for at in around)
    best = result
    for spacing in SPACINGS:
        for name, within in zip(names, bounds, strict=True):
            beside = best.values[name] + spacing * np.arange(-ABREAST, ABREAST + 1)
            at_once = partial(_moved, problem, best, name)
            tried = each(at_once, np.unique(np.clip(beside, *within)).tolist())
            best = min([best, *tried], key=lambda model: model.objective)
    return _Instants(tuple(best.values[name] for name in names), bounds, best.states)


def _moved(problem: Problem, result: Fit, name: str, at: float) -> Fit:
    return fit(problem, {**result.values, name: at}, (), result.states, iterations=3)


def _sharpened(problem: Problem, result: Fit) -> Fit:
    """The fit gone on with, its instants' derivatives taken over less: they are close by now."""
    free = tuple(replace(parameter, resolution=parameter.resolution * SHARPER) for parameter in result.free)
    exact = replace(problem, slope_step=problem.shooting.step_size)
    again = fit(exact, result.values, free, result.states, iterations=8)
    return again if again.objective < result.objective else result
