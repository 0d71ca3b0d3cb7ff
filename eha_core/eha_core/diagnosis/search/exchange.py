"""Exchange: what could take a member's place.

A load is imitated by a valve's null offset and a sensor's bias, oil with air in it by a damping that drifts: what is
taken for the other early stays for what the others have adapted to. So a member is taken out, and the catalogue
competes for its place beside all else as it is.
"""

from __future__ import annotations

from dataclasses import replace

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

AHEAD_AFTER_ONE = 2
"""How many more compete over short windows, those ahead after one iteration: a large effect that another compensates
for is not where a linear prediction has it (an orifice leak was the 9th and the 14th in the place of a bias and of a
deadband, and first after one iteration; two development rigs)."""

ITERATIONS = 15
"""Of a fit of a rival, which gives up where it cannot come close."""


def exchange(search: Search, best: Candidate) -> Candidate:
    """The best set after every member's place was competed for; the same where none is better."""
    for member in weakest_first(best):
        race(search, rivals_for(search, best, member))
        reached = search.best
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
    for it, and a fit of the rival would begin there. Over short windows, where an iteration is cheap, those that are
    ahead after one compete, too.
    """
    proposals = at_the_fit(search, _without(search, best, member), len(search.applicable))
    # the windows begin as measured: where the member led them, a fit may rest
    rivals = [
        replace(proposal, states=None) for proposal in proposals if not best.hypothesis.holds(proposal.hypothesis)
    ]
    chosen, others = rivals[:FOR_ONE_PLACE], rivals[FOR_ONE_PLACE:]
    if search.short:
        after_one = {candidate.hypothesis: candidate.fit.objective for candidate in search.try_proposals(others, 1)}
        chosen += sorted(others, key=lambda proposal: after_one[proposal.hypothesis])[:AHEAD_AFTER_ONE]
    return chosen


def _without(search: Search, best: Candidate, member: Member) -> Candidate:
    """The set without a member, at its own values for all else, from where all of them may move."""
    values, free = without_effect(best.fit, member.effect)
    alone = fit(search.problem, values, (), best.fit.states, iterations=OF_STATES)
    return Candidate(best.hypothesis.without(member), set_free(alone, free))


def rivals_with_one_more(search: Search, best: Candidate, needed: float) -> list[Candidate]:
    """The near rivals of the best set with what one more effect is predicted to gain most, where that would lead.

    What stands in the place of two members explains more than either alone: an offset that of a load and a late sensor.
    """
    size, enough = len(best.hypothesis.members), best.fit.objective - needed
    near = [
        candidate
        for candidate in search
        if len(candidate.hypothesis.members) == size
        and candidate.hypothesis != best.hypothesis
        and candidate.fit.objective < best.fit.objective + OUT_OF_REACH
    ]
    leading = [
        proposal
        for rival in (near if size < MOST_EFFECTS else ())
        for proposal in at_the_fit(search, rival, 1)
        if rival.fit.objective - proposal.predicted < enough
    ]
    return search.try_proposals(leading, ITERATIONS, give_up_above=enough)
