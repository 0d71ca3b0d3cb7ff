"""Grow: add to the best set what explains most, until nothing explains much or only noise is left."""

from __future__ import annotations

from collections.abc import Sequence

from eha_core.diagnosis.criteria import FAR_FROM_NOISE, MOST_EFFECTS, UNFITTED, chance_gain, gain_to_go_on
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.proposals import guesses_beside, proposals
from eha_core.diagnosis.search.prune import look_back
from eha_core.diagnosis.search.screening import ScoreTest, screen_in_time
from eha_core.diagnosis.search.short_windows import set_with_friction
from eha_core.diagnosis.search.time_limited import time_limited_beside

LEGS = ((3, 4), (4, 2), (10, 1))
"""A race: so many iterations for every proposal, and so many then go on. The right ones lead after two or three."""


def grow(search: Search, best: Candidate) -> Candidate:
    """The best set that adding to `best` leads to; every set that was fitted stays with the search."""
    while len(best.hypothesis.members) < MOST_EFFECTS and not search.is_over:
        score_tests = screen_in_time(search.problem, best.fit, guesses_beside(search, best))
        if not search.short:
            try_for_a_while(search, best, score_tests)
        race(search, proposals(search, best, score_tests, chance_gain(search.problem.count(), best.times_noise)))
        reached = search.best
        if reached.hypothesis != best.hypothesis and reached.times_noise > UNFITTED:
            # the next effect would make up for what a fit that stopped short leaves
            reached = set_with_friction(search, reached)
        if reached.times_noise < FAR_FROM_NOISE:
            search.measure_noise(reached)
            reached, best = search.again(reached), search.again(best)
        samples, left = search.problem.count(), best.fit.data - best.fit.count
        if best.fit.objective - reached.fit.objective < gain_to_go_on(samples, reached.times_noise, left):
            break
        best = look_back(search, reached, chance_gain(samples, reached.times_noise))
        search.report(best)
    return best


def try_for_a_while(search: Search, best: Candidate, score_tests: Sequence[ScoreTest]) -> None:
    """Fit what may act over an interval beside the best set, where windows in a row are predicted to gain as much as
    the next set must."""
    needed = gain_to_go_on(search.problem.count(), best.times_noise, best.fit.data - best.fit.count)
    begin = guesses_beside(search, best)
    found = time_limited_beside(search.problem, best.hypothesis, best.fit, begin, score_tests, needed, search.progress)
    for hypothesis, result in found.items():
        search.keep(hypothesis, result)


def race(search: Search, proposals: Sequence[Proposal]) -> None:
    """Fit every proposal a little, and the better ones further."""
    for iterations, kept in LEGS:
        ran = {candidate.hypothesis: candidate for candidate in search.try_proposals(proposals, iterations)}
        ahead = sorted(ran.values(), key=lambda candidate: candidate.fit.objective)[:kept]
        proposals = [candidate.further for candidate in ahead]
