"""Stage 4b, name: the hypotheses of the largest predicted gain refitted with every nominal parameter free, and
compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import ADEQUATE, ENOUGH, FAR_FROM_NOISE, HARDLY, OVER, parameter_cost
from eha_core.diagnosis.effect_parameters import parameters_used
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.search.converge import comes_near, converge
from eha_core.diagnosis.search.found import Found, Progress, keep_better
from eha_core.diagnosis.search.initial_guesses import initial_guesses
from eha_core.diagnosis.search.planned_refits import planned_refits, refit_with
from eha_core.diagnosis.search.screening import ScoreTest, screen_in_time
from eha_core.diagnosis.search.time_limited import time_limited_effects
from eha_core.diagnosis.search.warm_start import refit_nominal, warm_start
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.problem import Problem

REFINED = 8
"""How many hypotheses are refitted in full after a screening."""


@dataclass(frozen=True)
class Entry:
    """A hypothesis (no effect: the nominal model) with its fit. `score` is against the nominal model, in chi^2, its
    `cost` for parameters paid."""

    hypothesis: Hypothesis
    fit: Fit
    score: float
    cost: float = 0.0

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, by id."""
        return self.hypothesis.effects

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the effects, sorted."""
        return self.hypothesis.ids


@dataclass(frozen=True)
class ModelComparison:
    """All that was refitted, the best first, the nominal model among them with score 0; the screening's score tests;
    what one more effect beside the best is predicted to gain, the most of each site; and whether the search for sets
    was cut short."""

    nominal: Entry
    entries: tuple[Entry, ...]
    score_tests: tuple[ScoreTest, ...]
    residual_variance: float
    left_over: Mapping[str, float] = field(default_factory=dict)
    cut_short: bool = False


def compete(
    problem: Problem, calibrated: Fit, candidates: Sequence[Effect], scales: Scales, progress: Progress = lambda _: None
) -> ModelComparison:
    """Screen every candidate; refit those that may act over an interval, if any, and the best of the others."""
    progress("screening the catalogue")
    guesses = [guess for effect in candidates for guess in initial_guesses(effect, scales)]
    screened = screen_in_time(problem, calibrated, guesses)
    score_tests = tuple(score_test for score_test in screened if score_test.windows is None)
    limited = time_limited_effects(problem, calibrated, guesses, screened, ENOUGH, progress)
    found: Found = {}
    best = min([calibrated.objective, *(result.objective for result in limited.values())])
    nearly_all = problem.count() + OVER * (calibrated.objective - problem.count())
    # a share of what a calibration that is far off leaves is still far from noise
    enough = max(ADEQUATE * problem.count(), min(nearly_all, FAR_FROM_NOISE * problem.count()))
    for planned in planned_refits(problem, calibrated, guesses, score_tests, REFINED, ENOUGH):
        effect = planned.score_test.guess.effect
        if best < enough and planned.score_test.gain < HARDLY * (calibrated.objective - best):
            continue
        progress(f"refitting with {effect.id}")
        result = refit_with(problem, planned, best)
        keep_better(found, NOTHING.with_effects([effect]), result)
        best = min(best, result.objective)
    # single effects far off need not converge, nor those that always act where one over an interval leads by far
    if best < FAR_FROM_NOISE * problem.count() or limited:
        for_a_while = min((result.objective for result in limited.values()), default=np.inf)
        near = {hypothesis: result for hypothesis, result in found.items() if comes_near(problem, result, for_a_while)}
        found |= warm_start(problem, converge(problem, near, progress))
    return _ranked(problem, calibrated, {**limited, **found}, score_tests)


def _ranked(problem: Problem, calibrated: Fit, found: Found, score_tests: tuple[ScoreTest, ...]) -> ModelComparison:
    nominal = refit_nominal(problem, calibrated, list(found.values()))
    entries = rank(problem, nominal, found)
    return ModelComparison(Entry(NOTHING, nominal, 0.0), entries, score_tests, residual_variance(nominal, entries))


def residual_variance(nominal: Fit, entries: Sequence[Entry]) -> float:
    """Variance of the residual in units of the assumed noise, under the best model and never below one."""
    best = min([nominal, *(entry.fit for entry in entries)], key=lambda result: result.objective)
    return max(1.0, best.data / best.count)


def rank(problem: Problem, nominal: Fit, found: Found) -> tuple[Entry, ...]:
    """Scores: the gain over the nominal model in units of the residual's variance, less the cost of its parameters."""
    best = min([nominal, *found.values()], key=lambda result: result.objective)
    variance = max(1.0, best.data / best.count)
    entries = []
    for hypothesis, result in found.items():
        cost = (parameters_used(result) - len(nominal.free)) * parameter_cost(problem.count(), variance)
        gain = (nominal.objective - result.objective) / variance
        entries.append(Entry(hypothesis, result, gain - cost, cost))
    return tuple(sorted(entries, key=lambda entry: -entry.score))


def bounded(entry: Entry) -> bool:
    """Whether one of the effects has all its sizes at a bound or at nothing: then it explains nothing of its own."""
    return any(_is_nothing(effect, entry.fit) for effect in entry.effects)


def _is_nothing(effect: Effect, result: Fit) -> bool:
    switches = [
        np.isclose(result.values[name], row.nominal, atol=1e-6 * abs(row.typical))
        for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)
        if row.switches
    ]
    return bool(switches) and all(switches)


def site_gains(comparison: ModelComparison) -> dict[str, float]:
    """The refitted gain of each site's best hypothesis, or else the predicted one, which never counts as much."""
    gains: dict[str, float] = {}
    nominal = comparison.nominal.fit
    refitted: dict[str, float] = {}
    for entry in comparison.entries:  # an effect may be among them twice: acting always, and over an interval
        if len(entry.ids) == 1:
            gain = nominal.objective - entry.fit.objective
            refitted[entry.ids[0]] = max(gain, refitted.get(entry.ids[0], gain))
    most = max([0.0, *refitted.values()])
    for score_test in comparison.score_tests:
        effect = score_test.guess.effect
        gain = refitted.get(effect.id, min(score_test.gain, 0.5 * most))
        if gain > gains.get(effect.site, 0.0):
            gains[effect.site] = gain
    return gains
