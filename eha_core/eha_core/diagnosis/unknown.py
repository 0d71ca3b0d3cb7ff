"""A law outside the catalogue: a curve over the variable that explains most, alone or together with named effects."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError

from eha_core.curve import KNOTS
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import CONVINCING, FURTHER, LEFT_OVER, UNFITTED, chance_gain, parameter_cost
from eha_core.diagnosis.hypothesis import Hypothesis, without_effect
from eha_core.diagnosis.search.columns import LAWS, range_of
from eha_core.diagnosis.search.comparison import Entry, ModelComparison
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter, coordinates
from eha_core.identification.observation import WITH_OIL
from eha_core.identification.problem import Problem, linearise, normal_equations
from eha_core.identification.shooting import Shooting

FULLY_FITTED = 2
"""How many of the curves with the largest predicted gain are fitted in full."""


@dataclass(frozen=True)
class Recovery:
    """The best curve: its effect and variable, the hypothesis (with the named effects), the fit, the score as of an
    `Entry`, the share that it explains of the same effects' excess chi^2 without it, and its identified knots."""

    effect: Effect
    variable: str
    hypothesis: Hypothesis
    fit: Fit
    score: float
    share: float
    knots: tuple[tuple[float, float], ...]

    @property
    def named(self) -> tuple[Effect, ...]:
        """The catalogued effects that were fitted with the curve."""
        return tuple(effect for effect in self.hypothesis.effects if effect.named)


def recover(
    problem: Problem, comparison: ModelComparison, scales: Scales, progress: Callable[[str], None] = lambda _: None
) -> Recovery | None:
    """Fit curves if the residual of the best set exceeds the noise: alone, and together with the set's effects.

    None where the residual is noise, or no curve improves the fit.
    """
    nominal = comparison.nominal.fit
    best = comparison.entries[0] if comparison.entries else comparison.nominal
    if best.hypothesis.law is not None:
        return _of_the_set(best, comparison)
    if best.fit.data / best.fit.count < 1.0 + LEFT_OVER or nominal.data / nominal.count < 1.0 + LEFT_OVER:
        return None
    progress("recovering an unknown law as a curve")
    bases = [comparison.nominal, *([best] if best.effects and not best.hypothesis.limited else [])]
    found = [_beside(problem, base, comparison, scales, progress) for base in bases]
    # with a curve that is not the law either, a named effect only compensates for the curve's residual
    stands = [
        recovery
        for recovery in found
        if recovery is not None and not (recovery.named and recovery.fit.data > UNFITTED * recovery.fit.count)
    ]
    return max(stands, key=lambda recovery: recovery.score, default=None)


def _of_the_set(best: Entry, comparison: ModelComparison) -> Recovery:
    """The recovered law of the best set."""
    law = best.hypothesis.law
    assert law is not None
    without = comparison.smaller.get(best.hypothesis.without(law), comparison.nominal.fit)
    share = (without.data - best.fit.data) / max(without.data - best.fit.count, 1.0)
    return Recovery(
        law.effect, law.variable, best.hypothesis, best.fit, best.score, float(np.clip(share, 0.0, 1.0)),
        _identified_knots(law.effect, best.fit),
    )  # fmt: skip


def _beside(
    problem: Problem, base: Entry, comparison: ModelComparison, scales: Scales, progress: Callable[[str], None]
) -> Recovery | None:
    """The best curve together with an entry's effects, without those that the curve makes unnecessary."""
    fits = []
    for effect, variable, result in _fitted_curves(problem, base, scales, progress):
        law = base.hypothesis.with_effects([effect], variable=variable)
        fits.append((law, effect, variable, result))
    if not fits:
        return None
    hypothesis, effect, variable, result = min(fits, key=lambda curve: curve[3].objective)
    hypothesis, result = _without_idle(problem, hypothesis, result)
    nominal = comparison.nominal.fit
    variance = max(1.0, min(result.data / result.count, comparison.residual_variance))
    cost = (len(result.free) - len(nominal.free)) * parameter_cost(problem.count(), variance)
    share = (base.fit.data - result.data) / max(base.fit.data - base.fit.count, 1.0)
    return Recovery(
        effect, variable, hypothesis, result, (nominal.objective - result.objective) / variance - cost,
        float(np.clip(share, 0.0, 1.0)), _identified_knots(effect, result),
    )  # fmt: skip


def _fitted_curves(
    problem: Problem, base: Entry, scales: Scales, progress: Callable[[str], None]
) -> Iterator[tuple[Effect, str, Fit]]:
    """The curves with the largest predicted gain together with an entry's effects, fitted."""
    score_tests = []
    for effect, variable, values in _curves(base.fit.values, scales, problem.shooting):
        free = (*base.fit.free, *_knots_free(effect, values, scales))
        score_tests.append((_predicted_gain(problem, base.fit, values, free), effect, variable, values, free))
    score_tests.sort(key=lambda score_test: -score_test[0])
    beside = f" together with {' and '.join(base.ids)}" if base.ids else ""
    for gain, effect, variable, values, free in score_tests[:FULLY_FITTED]:
        if gain > 0.0:
            progress(f"fitting {effect.id} over {variable}{beside}")
            yield effect, variable, fit(problem, values, free, base.fit.states, iterations=10)


def _without_idle(problem: Problem, hypothesis: Hypothesis, result: Fit) -> tuple[Hypothesis, Fit]:
    """The hypothesis without the named effects that only compensated for the law."""
    needed = chance_gain(problem.count(), result.data / result.count)
    for member in hypothesis.members:
        if not member.effect.named:
            continue
        values, free = without_effect(result, member.effect)
        simpler = fit(problem, values, free, result.states, iterations=FURTHER)
        left = max(result.data - result.count, 0.0)
        if simpler.objective - result.objective < max(needed, CONVINCING / (1.0 - CONVINCING) * left):
            hypothesis, result = hypothesis.without(member), simpler
    return hypothesis, result


def _curves(
    values: Mapping[str, float], scales: Scales, shooting: Shooting
) -> Iterator[tuple[Effect, str, dict[str, float]]]:
    for effect in shooting.composition.effects:
        if effect.named or (shooting.drive not in WITH_OIL and effect.site != "force"):
            continue
        for place, variable in enumerate(LAWS[effect.id]):
            covered = range_of(variable, scales)
            if covered is None:
                continue
            chosen = {**values, f"{effect.id}.lower": covered[0], f"{effect.id}.upper": covered[1]}
            if f"{effect.id}.variable" in values:
                chosen[f"{effect.id}.variable"] = float(place)
            yield effect, variable, chosen


def _knots_free(effect: Effect, values: Mapping[str, float], scales: Scales) -> tuple[FreeParameter, ...]:
    if effect.site == "force":
        scale = scales.by_quantity["force"][1]
    elif effect.site == "orifice":
        scale = scales.by_quantity["spool"][1]
    else:
        scale = scales.by_quantity["leakage_flow"][1] * scales.by_quantity["pressure"][1]
    rows = zip(effect.parameter_names(), effect.parameters, strict=True)
    return tuple(
        FreeParameter(name, values[name], False, scale, 3.0, row.lower, row.upper) for name, row in rows if row.switches
    )


def _predicted_gain(
    problem: Problem, nominal: Fit, values: Mapping[str, float], free: tuple[FreeParameter, ...]
) -> float:
    """The reduction of chi^2 that the linearised problem predicts for the curve."""
    q = coordinates(free, values)
    linear = linearise(problem, values, free, q, nominal.states)
    normal, gradient = normal_equations(problem, free, q, nominal.states, linear)
    try:
        return float(gradient @ normal.eliminate(1e-9).solve(gradient))
    except (LinAlgError, ValueError):
        return 0.0


def _identified_knots(effect: Effect, result: Fit) -> tuple[tuple[float, float], ...]:
    """The curve's knots that the recording identifies."""
    lower, upper = result.values[f"{effect.id}.lower"], result.values[f"{effect.id}.upper"]
    places = np.linspace(lower, upper, KNOTS)
    found = []
    names = [parameter.name for parameter in result.free]
    for place, k in zip(places, range(KNOTS), strict=True):
        name = f"{effect.id}.knot_{k:02d}"
        index = names.index(name)
        if np.sqrt(max(result.covariance[index, index], 0.0)) < 0.5 * result.free[index].prior_deviation:
            found.append((float(place), float(result.values[name])))
    return tuple(found)
