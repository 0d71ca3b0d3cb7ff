"""Exchange: what could take a member's place.

A load is imitated by a valve's null offset and a sensor's bias, oil with air in it by a damping that drifts: what is
taken for the other early stays for what the others have adapted to. So a member is taken out, everything else is fitted
without it, and the catalogue competes for its place.
"""

from __future__ import annotations

from eha_core.diagnosis.criteria import chance_gain, gain_to_go_on
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.grow import race
from eha_core.diagnosis.search.proposals import at_the_fit
from eha_core.diagnosis.search.prune import look_back, refit_without, wald

FOR_ONE_PLACE = 4
"""How many effects compete for a member's place, those that predict most there."""


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
    """What has the largest predicted gain in a member's place when the others are fitted without it."""
    rest = refit_without(search, best, member)
    proposals = at_the_fit(search, rest, FOR_ONE_PLACE + 1)
    return [one for one in proposals if one.hypothesis != best.hypothesis][:FOR_ONE_PLACE]
