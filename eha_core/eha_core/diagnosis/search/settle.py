"""Settle: hold a set against what could stand in its members' places, until nothing takes its place."""

from __future__ import annotations

from eha_core.diagnosis.criteria import chance_gain
from eha_core.diagnosis.hypothesis import Hypothesis
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.exchange import ITERATIONS, rivals_for, rivals_with_one_more
from eha_core.diagnosis.search.found import OUT_OF_REACH
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.proposals import in_another_form
from eha_core.diagnosis.search.prune import prune
from eha_core.diagnosis.search.simpler_form import for_its_cost, try_forms

ROUNDS = 3
"""How often a set that one of its rivals took the place of is held against its own."""


def settle(search: Search, best: Candidate) -> Candidate:
    """The best set when it, and each that took its place, was held against its rivals."""
    held_against: set[Hypothesis] = set()
    for _ in range(ROUNDS):
        before, best = best.hypothesis, _against_its_rivals(search, best, held_against)
        if best.hypothesis == before or search.is_over:
            break
        # it may lead because its fit converged further, and not because of its new member
        best = prune(search, grow(search, best))
    return best


def _against_its_rivals(search: Search, best: Candidate, held_against: set[Hypothesis]) -> Candidate:
    """The best set when what has the largest predicted gain in a member's place was fitted to where it can be
    distinguished, and with one effect more where that is predicted to lead; `held_against` grows by the places that
    were competed for."""
    for member in best.hypothesis.members:
        rest = best.hypothesis.without(member)
        if rest in held_against:
            continue
        held_against.add(rest)
        rivals = rivals_for(search, best, member)
        new = [proposal for proposal in rivals if search.short or proposal.hypothesis not in search.found]
        search.try_proposals(new, ITERATIONS, give_up_above=best.fit.objective + OUT_OF_REACH)
    size = len(best.hypothesis.members)
    needed = chance_gain(search.problem.count(), best.times_noise)
    larger = rivals_with_one_more(search, best, needed)
    while True:
        try_forms(search, best, in_another_form(search, best))
        leading = for_its_cost(search, [candidate for candidate in search if len(candidate.hypothesis.members) == size])
        if leading.hypothesis == best.hypothesis:
            break
        # where friction sticks, the fit of a simpler form may have stopped above its optimum, and goes on from here
        best = leading
    # an effect more has to gain what it could not by chance
    return min(
        (best, *larger), key=lambda candidate: candidate.fit.objective + (needed if candidate in larger else 0.0)
    )
