"""Effects that act for a while: what a model with its effects always on, or never, cannot explain.

Windows in a row in which an effect is predicted to gain far more than over the whole record tell where to look. The
nominal equations are then fitted to the rest of the record alone, which has not bent their parameters, and the
catalogue is screened once more from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import log

import numpy as np

from eha_core.diagnosis.criteria import OUTSTANDING
from eha_core.diagnosis.effect_freedom import effect_freedom, span_freedom
from eha_core.diagnosis.hypotheses import Start
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.refine import OUT_OF_REACH, Found, Progress, cross, settle
from eha_core.diagnosis.screen import ScoreTest, scaled, screen_in_time
from eha_core.identification.fit import Fit, fit, fit_in_stages, refit_states
from eha_core.identification.numbers import Array
from eha_core.identification.parallel import each
from eha_core.identification.problem import Problem
from eha_core.parameters import ACTING

SPACINGS = (0.25, 0.0625, 0.015, 0.004)
ABREAST = 4
"""s; an instant is tried so many times to either side of where it is taken to be, ever more closely. The search is by
trial, for an instant that is wrong by more than a moment shows no slope that leads to the right one."""

SHARPER = 0.1
"""Share of the usual span over which an instant's derivative is taken once it is known closely."""

TOUCHING = 1e-6
"""s; a window that begins where a span ends touches it."""

TRIED = 4
"""How many effects are fitted with the span in which they act."""


def passing_effects(
    problem: Problem,
    calibrated: Fit,
    initial_guesses: Sequence[Start],
    score_tests: Sequence[ScoreTest],
    least: float,
    progress: Progress = lambda _: None,
) -> Found:
    """Effects with the span in which they act, fitted; none where the predicted gains of the record's windows show no
    such thing, or less than `least`."""
    always = max([0.0, *(one.gain for one in score_tests if one.windows is None)])
    best = max((one for one in score_tests if one.windows is not None), key=lambda one: one.gain, default=None)
    if best is None or best.gain < least + 2.0 * log(problem.count()) or best.gain < OUTSTANDING * always:
        return {}
    assert best.windows is not None
    outside = _fitted_outside(problem, calibrated, best.windows)
    progress("looking when an effect acts")
    chosen = _one_each(screen_in_time(problem, outside, initial_guesses))
    begun = [_of_fixed_span(problem, outside, score_test) for score_test in chosen]
    instants = _located(problem, min(begun, key=lambda one: one.objective))
    found: Found = {}
    reached = calibrated.objective
    for score_test, beginning in zip(chosen, begun, strict=True):
        effect = score_test.start.effect
        progress(f"refitting with {effect.id} for a while")
        values = {**beginning.values, **instants.values}
        free = (*outside.free, *effect_freedom(effect, values), *span_freedom(instants.values, instants.bounds))
        result = fit(problem, values, free, instants.states, iterations=25, give_up_above=reached + OUT_OF_REACH)
        reached = min(reached, result.objective)
        found[NOTHING.with_effects([effect], limited=True)] = result
    crossed = cross(problem, settle(problem, found, progress))
    sharpened = {hypothesis: _sharpened(problem, result) for hypothesis, result in crossed.items()}
    # half a millisecond beside another's instants a law would seem to explain less than a richer form of it
    return cross(problem, sharpened)


def _fitted_outside(problem: Problem, nominal: Fit, windows: tuple[int, int]) -> Fit:
    """The nominal equations as all windows but these, and those that touch them, have them; every window's start."""
    begin, end = _span_of(problem, windows)
    local = problem.shooting.local_edges
    # a window that only touches the span is inside, too
    inside = np.flatnonzero((local[:, 1] >= begin - TOUCHING) & (local[:, 0] <= end + TOUCHING))
    rest = np.setdiff1d(problem.windows, inside)
    if len(rest) < 2:
        return nominal
    untouched = {one.name: one.reference for one in nominal.free}
    fitted = fit_in_stages(replace(problem, windows=rest), {**nominal.values, **untouched}, nominal.free)
    started = refit_states(problem, fitted)
    return fit(problem, fitted.values, nominal.free, started.states, iterations=0)


def _span_of(problem: Problem, windows: tuple[int, int]) -> tuple[float, float]:
    """When these windows in a row begin and end [s] in their recording."""
    local = problem.shooting.local_edges
    return float(local[windows[0], 0]), float(local[windows[1] - 1, 1])


def _one_each(score_tests: Sequence[ScoreTest]) -> list[ScoreTest]:
    best: dict[str, ScoreTest] = {}
    for one in score_tests:
        if one.windows is not None:
            best.setdefault(one.start.effect.id, one)
    return list(best.values())[:TRIED]


def _of_fixed_span(problem: Problem, base: Fit, score_test: ScoreTest) -> Fit:
    """The effect's own parameters fitted, in the span that the windows tell, and nothing else."""
    assert score_test.windows is not None
    begin, end = _span_of(problem, score_test.windows)
    values = {**base.values, **scaled(score_test), "effects_from": begin, "effects_until": end}
    return fit(problem, values, effect_freedom(score_test.start.effect, values), base.states, iterations=8)


@dataclass(frozen=True)
class _Instants:
    """When the effects begin and cease to act [s], between which bounds, and the windows' starts under that."""

    values: Mapping[str, float]
    bounds: Mapping[str, tuple[float, float]]
    states: Array


def _located(problem: Problem, result: Fit) -> _Instants:
    """Move either instant by trial, with the windows' starts alone free."""
    longest = float(np.max(problem.shooting.local_edges))
    reach = ABREAST * SPACINGS[0]
    instants = {row.name: result.values[row.name] for row in ACTING}
    bounds = {name: (max(at - reach, 0.0), min(at + reach, longest)) for name, at in instants.items()}
    best = result
    for spacing in SPACINGS:
        for name in instants:
            beside = best.values[name] + spacing * np.arange(-ABREAST, ABREAST + 1)
            at_once = partial(_moved, problem, best, name)
            tried = each(at_once, np.unique(np.clip(beside, *bounds[name])).tolist())
            best = min([best, *tried], key=lambda one: one.objective)
    return _Instants({name: best.values[name] for name in instants}, bounds, best.states)


def _moved(problem: Problem, result: Fit, name: str, at: float) -> Fit:
    return fit(problem, {**result.values, name: at}, (), result.states, iterations=3)


def _sharpened(problem: Problem, result: Fit) -> Fit:
    """The fit gone on with, its instants' derivatives taken over less: they are close by now."""
    free = tuple(replace(one, resolution=one.resolution * SHARPER) for one in result.free)
    exact = replace(problem, slope_step=problem.shooting.step_size)
    again = fit(exact, result.values, free, result.states, iterations=8)
    return again if again.objective < result.objective else result
