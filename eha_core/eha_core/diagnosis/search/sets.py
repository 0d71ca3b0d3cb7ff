"""Stage 4b, any number of effects: the single effects' comparison carried on to sets.

The search works in the noise that its best set shows; what the calibration and the single effects left is weighed anew
in that noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import FAR_FROM_NOISE
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Search, in_noise_of
from eha_core.diagnosis.search.converge import converge
from eha_core.diagnosis.search.found import Found, Progress
from eha_core.diagnosis.search.model_comparison import Entry, ModelComparison, rank, residual_variance
from eha_core.diagnosis.search.proposals import at_the_fit
from eha_core.diagnosis.search.prune import prune
from eha_core.diagnosis.search.search import search_sets
from eha_core.diagnosis.search.settle import settle
from eha_core.diagnosis.search.simpler_form import CLOSE, for_its_cost
from eha_core.diagnosis.search.warm_start import refit_nominal, warm_start
from eha_core.effects import Effect


def with_sets(
    calibration: Calibration,
    comparison: ModelComparison,
    applicable: Sequence[Effect],
    scales: Scales,
    progress: Progress = lambda _: None,
) -> tuple[Calibration, ModelComparison]:
    """The comparison with the best set in it and whatever comes near that, and the calibration in the noise found."""
    singles = {entry.hypothesis: entry.fit for entry in comparison.entries}
    found: Found = {**singles, NOTHING: comparison.nominal.fit}
    short = calibration.shorter, calibration.shortest
    search = Search(calibration.problem, applicable, scales, progress, found, *short)
    best = search_sets(search, search.again(Candidate(NOTHING, comparison.nominal.fit)))
    if len(best.hypothesis.members) > 1:
        # a set that stopped short would make any other form of a law look better
        converged = converge(search.problem, {best.hypothesis: best.fit}, progress)
        best = search.keep(best.hypothesis, converged[best.hypothesis])
        best = settle(search, best)
    calibration = _in_noise_of(search, calibration)
    found = {hypothesis: search.found[hypothesis] for hypothesis in singles}
    if len(best.hypothesis.members) > 1:
        near = _near(search, best)
        leading = for_its_cost(search, [Candidate(hypothesis, result) for hypothesis, result in near.items()])
        if leading.hypothesis != best.hypothesis:
            # another form of a member's law may not need what was beside that
            best = prune(search, leading)
            near = near if best.hypothesis == leading.hypothesis else _near(search, best)
        found |= near
        worse = [hypothesis for hypothesis in singles if best.hypothesis.holds(hypothesis)]
        found = {hypothesis: result for hypothesis, result in found.items() if hypothesis not in worse}
    elif best.hypothesis != NOTHING:  # a single effect that acts over an interval may have been found beside another
        found[best.hypothesis] = best.fit
    if len(best.hypothesis.members) < 2 and best.times_noise > FAR_FROM_NOISE and not best.hypothesis.limited:
        # no set came near the noise either: the single effects are compared, and have to converge for that
        always = {hypothesis: result for hypothesis, result in found.items() if not hypothesis.limited}
        found |= warm_start(search.problem, converge(search.problem, always, progress))
    nominal = refit_nominal(search.problem, search.found[NOTHING], list(found.values()))
    entries = rank(search.problem, nominal, found)
    left_over = {} if best.hypothesis.limited else _left_over(search, best)
    nothing, spread = Entry(NOTHING, nominal, 0.0), residual_variance(nominal, entries)
    compared = ModelComparison(nothing, entries, comparison.score_tests, spread, left_over, search.is_over)
    return calibration, compared


def _near(search: Search, best: Candidate) -> Found:
    """The best set and those of its size that come near it, fitted until they can be compared."""
    size, behind = len(best.hypothesis.members), CLOSE * max(1.0, best.times_noise)
    near = {
        candidate.hypothesis: candidate.fit
        for candidate in search
        if len(candidate.hypothesis.members) == size and candidate.fit.objective < best.fit.objective + behind
    }
    return warm_start(search.problem, converge(search.problem, {**near, best.hypothesis: best.fit}, search.progress))


def _left_over(search: Search, best: Candidate) -> dict[str, float]:
    """What one more effect beside the best is predicted to gain, the most of each site."""
    gains: dict[str, float] = {}
    for proposal in at_the_fit(search, search.again(best), len(search.applicable)):
        added = next(member for member in proposal.hypothesis.members if member not in best.hypothesis.members)
        gains[added.effect.site] = max(proposal.predicted, gains.get(added.effect.site, 0.0))
    return gains


def _in_noise_of(search: Search, calibration: Calibration) -> Calibration:
    return replace(
        calibration,
        shooting=search.problem.shooting,
        problem=search.problem,
        nominal=in_noise_of(search.problem, calibration.shooting, calibration.nominal),
        fitted=in_noise_of(search.problem, calibration.shooting, calibration.fitted),
    )
