"""Stage 4c, decide: name, abstain, or say that nothing is missing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log

import numpy as np

from eha_core.curve import KNOTS
from eha_core.diagnosis.calibrate import Calibration, has_changed
from eha_core.diagnosis.criteria import (
    BLOCK,
    COHERENT,
    CONTENDING,
    ENOUGH,
    FAR_FROM_NOISE,
    HELD_OUT,
    ITS_FORM,
    LEAST_OF_A_LAW,
    NEARLY_ALL,
    PARTLY,
    TIE,
    UNFITTED,
    UNKNOWN_MARGIN,
    WHATEVER_FORM,
    parameter_cost,
)
from eha_core.diagnosis.search.comparison import Entry, ModelComparison, bounded
from eha_core.diagnosis.unknown import Recovery
from eha_core.effects import Effect
from eha_core.health.noise import NORMAL_MEDIAN, block_means
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.validate import Judged, instants_of, judge


@dataclass(frozen=True)
class Decision:
    """The verdict, its winner (the nominal entry where nothing is named) and the rivals it cannot be distinguished
    from; `as_given` where that is the nominal model with its own values, which nothing predicts better than."""

    verdict: str
    winner: Entry
    rivals: tuple[tuple[Entry, float], ...]
    judged_nominal: Judged | None
    judged_winner: Judged | None
    as_given: bool = False


def decide(
    calibration: Calibration, nominal: Mapping[str, float], comparison: ModelComparison, recovery: Recovery | None
) -> Decision:
    """Weigh the comparison's entries, the best first, and the recovered curve against them."""
    if recovery is not None and comparison.entries and recovery.hypothesis == comparison.entries[0].hypothesis:
        return _unnamed(calibration, comparison, recovery)
    if recovery is not None and _beats_the_catalogue(recovery, comparison):
        return _unnamed(calibration, comparison, recovery)
    standing = [entry for entry in comparison.entries if entry.score > ENOUGH and not bounded(entry)]
    winner = standing[0] if standing else comparison.nominal
    if _leaves_physics_over(winner.fit, comparison.nominal.fit):
        return _unnamed(calibration, comparison, recovery)
    if not standing:
        return without_physics(calibration, nominal, comparison)
    instants = instants_of(winner.fit)
    judged_nominal = judge(calibration.shooting, comparison.nominal.fit, instants)
    judged_winner = judge(calibration.shooting, winner.fit, instants)
    gain = (judged_nominal.chi_square - judged_winner.chi_square) / comparison.residual_variance
    if gain < HELD_OUT:
        return without_physics(calibration, nominal, comparison)
    rivals = tuple((entry, winner.score - entry.score) for entry in standing[1:] if _is_rival(winner, entry))
    verdict = "ambiguous" if rivals else "missing_physics"
    return Decision(verdict, winner, rivals, judged_nominal, judged_winner)


def _unnamed(calibration: Calibration, comparison: ModelComparison, recovery: Recovery | None) -> Decision:
    """Something is missing that no name fits: with the recovered curve, if one explains anything."""
    entry = comparison.nominal
    if recovery is not None and recovery.score > ENOUGH:
        entry = Entry(recovery.hypothesis, recovery.fit, recovery.score)
    judged = judge(calibration.shooting, comparison.nominal.fit)
    after = judge(calibration.shooting, entry.fit) if entry.effects else judged
    return Decision("unknown_physics", entry, (), judged, after)


def _leaves_physics_over(best: Fit, nominal: Fit) -> bool:
    """Whether what the best hypothesis leaves is coherent, large, and most of what there was to explain."""
    left, before = best.data - best.count, nominal.data - nominal.count
    if best.data < UNFITTED * best.count or left < PARTLY * before:
        return False
    return max(coherence(residual) for residual in best.residuals) > COHERENT


def coherence(residual: Array) -> float:
    """The size of a residual averaged over blocks (its median over the record), over what white noise would leave."""
    means = block_means(residual, BLOCK)
    if len(means) < 3:
        return 0.0
    return float(np.median(np.abs(means)) / NORMAL_MEDIAN * np.sqrt(BLOCK))


def _beats_the_catalogue(recovery: Recovery, comparison: ModelComparison) -> bool:
    """Whether the curve, with what is named beside it, explains so much more than the best named effects alone that its
    many knots are paid for.

    A curve that stays far above the noise is not the law either, but bends to whatever is there; then names that
    explain nearly all stand. So do they where the curve only draws the form of the law that they name.
    """
    best = comparison.entries[0] if comparison.entries else comparison.nominal
    variance = max(1.0, recovery.fit.data / recovery.fit.count)
    nominal, curve = comparison.nominal.fit, recovery.fit
    left = (best.fit.data - best.fit.count) / max(nominal.data - nominal.count, 1.0)
    if left < NEARLY_ALL and best.effects and curve.data > FAR_FROM_NOISE * curve.count:
        return False
    forms = [effect for effect in best.effects if effect.approximate]
    if left < WHATEVER_FORM and forms or left < ITS_FORM and any(form.site == recovery.effect.site for form in forms):
        return False
    if recovery.named and recovery.share < LEAST_OF_A_LAW:
        return False
    more = (best.fit.objective - recovery.fit.objective) / variance
    knots = KNOTS + _parameters(recovery.named) - _parameters(best.effects)
    return recovery.score > ENOUGH and more > UNKNOWN_MARGIN + knots * parameter_cost(recovery.fit.count, variance)


def _parameters(effects: Sequence[Effect]) -> int:
    return sum(len(effect.parameters) for effect in effects)


def contenders(winner: Entry, comparison: ModelComparison) -> tuple[Entry, ...]:
    """The winner and whatever comes within CONTENDING of it: what a further test has to tell apart.

    A set that merely adds to a better one is left out: it can imitate that one's outcome of any test.
    """
    found = [winner]
    for entry in comparison.entries:
        adds = any(set(better.ids) <= set(entry.ids) for better in found)
        if not adds and not bounded(entry) and _is_rival(winner, entry, CONTENDING):
            found.append(entry)
    return tuple(found)


def _is_rival(winner: Entry, entry: Entry, within: float = TIE) -> bool:
    """Another explanation as good as the winner's: not one that merely adds to it."""
    return winner.score - entry.score < within and not set(winner.ids) <= set(entry.ids)


def without_physics(calibration: Calibration, nominal: Mapping[str, float], comparison: ModelComparison) -> Decision:
    """Nothing is named: say whether parameters differ. A set of values differs if the data say so, taken together."""
    result = comparison.nominal.fit
    gain = calibration.nominal.objective - result.objective
    changed = [parameter.name for parameter in result.free if has_changed(result, nominal, parameter.name)]
    different = gain / comparison.residual_variance > ENOUGH + len(changed) * log(max(result.count, 2)) and changed
    return Decision("parameters" if different else "consistent", comparison.nominal, (), None, None)


def whiteness(residuals: Sequence[Array], lags: int = 20) -> list[float]:
    """Largest autocorrelation of each channel's residual over the first lags, in units of its expected deviation 1/sqrt
    n."""
    found = []
    for residual in residuals:
        centred = residual - residual.mean()
        power = float(centred @ centred) or 1.0
        correlations = [float(centred[:-lag] @ centred[lag:]) / power for lag in range(1, min(lags, len(centred) - 1))]
        found.append(max((abs(value) for value in correlations), default=0.0) * float(np.sqrt(len(centred))))
    return found
