"""Models fitted once more from the leader's values of what they share, so that all are compared at their optimum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from eha_core.diagnosis.hypothesis import Hypothesis
from eha_core.diagnosis.search.found import CONVERGE_WITHIN, OUT_OF_REACH, Found, best_first, keep_better
from eha_core.diagnosis.search.nominal_start import NOMINAL_NAMES
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.parallel import each
from eha_core.identification.per_recording import is_one_of
from eha_core.identification.problem import Problem

WARM_STARTED = 3
"""How many of the leaders behind the best are fitted once more from where it stands."""


def warm_start(problem: Problem, found: Found) -> Found:
    """The leaders fitted once more from where the best of them has what all models share, and the windows' starts.

    Where friction sticks, the objective is rugged: a law can rest far above its own optimum, and a richer one that
    holds it as a special case would win for that.
    """
    if len(found) < 2:
        return found
    leading, *others = best_first(found)
    best = found[leading]
    begun: list[tuple[Hypothesis, dict[str, float]]] = []
    for hypothesis in others[:WARM_STARTED]:
        result = found[hypothesis]
        both = (parameter.name for parameter in result.free if parameter.name in best.values)
        shared = {name: best.values[name] for name in both if is_one_of(name, NOMINAL_NAMES)}
        shared |= _same_interval(hypothesis, leading, best.values)
        kindred = _of_the_same_kind(hypothesis.effects, leading.effects, best.values)
        for own in (kindred, {}) if kindred else ({},):
            begun.append((hypothesis, {**result.values, **shared, **own}))

    def fitted(start: tuple[Hypothesis, dict[str, float]]) -> Fit:
        hypothesis, values = start
        worse = best.objective + OUT_OF_REACH
        return fit(problem, values, found[hypothesis].free, best.states, iterations=15, give_up_above=worse)

    warm_started = dict(found)
    for (hypothesis, _), again in zip(begun, each(fitted, begun), strict=True):
        keep_better(warm_started, hypothesis, again)
    return _to_their_ends(problem, warm_started)


def _to_their_ends(problem: Problem, found: Found) -> Found:
    """What comes near the best fitted until it gains nothing, with derivatives at the full step, from the windows'
    starts as they are and from those measured: a rival that stopped a little short would seem to be distinguished."""
    exact = replace(problem, slope_step=problem.shooting.step_size)
    best = min(result.objective for result in found.values())
    near = [hypothesis for hypothesis, at in found.items() if best < at.objective < best + CONVERGE_WITHIN]

    def fitted(start: tuple[Hypothesis, bool]) -> Fit:
        hypothesis, measured = start
        at = found[hypothesis]
        return fit(exact, at.values, at.free, None if measured else at.states, iterations=30)

    starts = [(hypothesis, measured) for hypothesis in near for measured in (False, True)]
    ended = dict(found)
    for (hypothesis, _), again in zip(starts, each(fitted, starts), strict=True):
        keep_better(ended, hypothesis, again)
    return ended


def _same_interval(hypothesis: Hypothesis, other: Hypothesis, values: Mapping[str, float]) -> dict[str, float]:
    """The interval in which the other's effect acts, for this one's, where each has one that acts over an interval."""
    if not (hypothesis.has_one_interval and other.has_one_interval):
        return {}
    names = (either.limited[0].effect.acting_names() for either in (hypothesis, other))
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


def refit_nominal(problem: Problem, calibrated: Fit, others: Sequence[Fit]) -> Fit:
    """The nominal model fitted once more from the best hypothesis' nominal values.

    A nominal fit that stopped in a flat valley would make any hypothesis that left it look like a discovery.
    """
    if not others:
        return calibrated
    best = min(others, key=lambda result: result.objective)
    names = {parameter.name for parameter in calibrated.free}
    values = {name: best.values[name] if name in names else value for name, value in calibrated.values.items()}
    again = fit(problem, values, calibrated.free, best.states)
    return again if again.objective < calibrated.objective else calibrated
