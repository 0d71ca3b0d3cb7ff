"""Exchange: what could take a member's place.

A load is imitated by a valve's null offset and a sensor's bias, oil with air in it by a damping that drifts: what is
taken for the other early stays for what the others have adapted to. So a member is taken out, and the catalogue
competes for its place beside all else as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

from eha_core.diagnosis.criteria import MOST_EFFECTS, chance_gain, gain_to_go_on
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search, without_effect
from eha_core.diagnosis.search.found import OUT_OF_REACH
from eha_core.diagnosis.search.grow import race
from eha_core.diagnosis.search.nominal_start import set_free
from eha_core.diagnosis.search.proposals import at_the_fit
from eha_core.diagnosis.search.prune import look_back, wald
from eha_core.identification.fit import fit
from eha_core.identification.short_windows import OF_STATES

FOR_ONE_PLACE = 4
"""How many effects compete for a member's place, those that predict most there."""

PAIRS = 3
"""How many pairs of members are put up for one effect in their place, those of which it is predicted to explain most
(assumed)."""

ITERATIONS = 15
"""Of a fit of a rival, which gives up where it cannot come close."""


def exchange(search: Search, best: Candidate) -> Candidate:
    """The best set after every member's place was competed for; the same where none is better."""
    for member in weakest_first(best):
        race(search, rivals_for(search, best, member))
        reached = min(search, key=lambda one: one.fit.objective)
        samples, left = search.problem.count(), best.fit.data - best.fit.count
        if best.fit.objective - reached.fit.objective > gain_to_go_on(samples, reached.times_noise, left):
            return look_back(search, reached, chance_gain(samples, reached.times_noise))
    return best


def weakest_first(candidate: Candidate) -> list[Member]:
    """The members, those first that the set could do without most easily."""
    return sorted(candidate.hypothesis.members, key=lambda member: wald(candidate.fit, member.effect))


def rivals_for(search: Search, best: Candidate, member: Member) -> list[Proposal]:
    """What has the largest predicted gain in a member's place, all else being as it is beside it.

    What imitates the member changes the channels as it does. Fitted without it, the others would first bend to make up
    for it, and a fit of the rival would begin there.
    """
    return _in_place(search, best, _beside(search, best, [member]))


def _in_place(search: Search, best: Candidate, rest: Candidate) -> list[Proposal]:
    """What is predicted to gain most beside what is left of the best set. The windows begin as measured: where the
    missing members led them, a fit may rest."""
    missing = len(best.hypothesis.members) - len(rest.hypothesis.members)
    proposals = at_the_fit(search, rest, FOR_ONE_PLACE + missing)
    others = [replace(one, states=None) for one in proposals if not best.hypothesis.holds(one.hypothesis)]
    return others[:FOR_ONE_PLACE]


def _beside(search: Search, best: Candidate, members: Sequence[Member]) -> Candidate:
    """The set without some members, at its own values for all else, from where all of them may move."""
    hypothesis, at = best.hypothesis, best.fit
    for member in members:
        values, free = without_effect(at, member.effect)
        hypothesis, at = hypothesis.without(member), set_free(replace(at, values=values), free)
    alone = fit(search.problem, at.values, (), at.states, iterations=OF_STATES)
    return Candidate(hypothesis, set_free(alone, at.free))


def one_in_place_of_two(search: Search, best: Candidate) -> list[Candidate]:
    """Smaller sets in which one effect takes the place of two members, fitted where that is predicted to explain most
    of what both do.

    An effect that was not found early is made up for by several, and beside these it has nothing left to explain.
    """
    chosen: list[tuple[float, Proposal]] = []
    for pair in combinations(best.hypothesis.members, 2):
        rest = _beside(search, best, pair)
        lost = max(rest.fit.objective - best.fit.objective, 1.0)
        chosen += [(one.predicted / lost, one) for one in _in_place(search, best, rest)[:1]]
    found = []
    for _, proposal in sorted(chosen, key=lambda one: -one[0])[:PAIRS]:
        search.progress(f"trying {' + '.join(proposal.hypothesis.ids)}")
        worst = best.fit.objective + OUT_OF_REACH
        found.append(search.try_proposal(proposal, ITERATIONS, give_up_above=worst))
    return found


def rivals_with_one_more(search: Search, best: Candidate, needed: float) -> list[Candidate]:
    """The near rivals of the best set with what one more effect is predicted to gain most, where that would lead.

    What stands in the place of two members explains more than either alone: an offset that of a load and a late sensor.
    """
    size, enough = len(best.hypothesis.members), best.fit.objective - needed
    near = [
        one
        for one in search
        if len(one.hypothesis.members) == size
        and one.hypothesis != best.hypothesis
        and one.fit.objective < best.fit.objective + OUT_OF_REACH
    ]
    found = []
    for rival in near if size < MOST_EFFECTS else ():
        for proposal in at_the_fit(search, rival, 1):
            if rival.fit.objective - proposal.predicted < enough:
                search.progress(f"trying {' + '.join(proposal.hypothesis.ids)}")
                found.append(search.try_proposal(proposal, ITERATIONS, give_up_above=enough))
    return found
