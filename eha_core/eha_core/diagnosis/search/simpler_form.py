"""Simpler form: what grows where a law's form has fewer parameters than the best set's.

The shape of a rich form takes what a weak member beside a plainer one would explain: Stribeck's curve bends as dry
friction with quadratic damping does. So where a plainer form comes near, the search goes on from there, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eha_core.diagnosis.criteria import parameter_cost
from eha_core.diagnosis.effect_parameters import parameters_used
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.proposals import in_another_form

CLOSE = 100.0
"""Chi^2 by which a set may lie behind the best and still be fitted to its end, or go on."""

OF_EXPLAINED = 0.005
"""Share of what the best set explains by which a simpler form may lie behind and go on, too: as much as one more weak
effect may explain beside it (assumed; damping beside dry friction explained 0.2 % of it, rig-0020 of seed 11300)."""

ITERATIONS = 20
"""Of a fit in another form, which gives up where it cannot come close."""


def from_a_simpler_form(search: Search, best: Candidate) -> Candidate:
    """The best set, or what grows from it in a form with fewer parameters where that explains as much for its cost."""
    simpler = [proposal for proposal in in_another_form(search, best) if len(proposal.free) < len(best.fit.free)]
    behind = max(CLOSE, OF_EXPLAINED * (search.found[NOTHING].objective - best.fit.objective))
    close = [
        candidate
        for candidate in try_forms(search, best, simpler, behind)
        if candidate.fit.objective < best.fit.objective + behind
    ]
    if not close:
        return best
    grow(search, min(close, key=lambda candidate: candidate.fit.objective))
    # the richer form may still have the least chi^2, and what grew beside the plainer one costs less
    return for_its_cost(search, list(search))


def try_forms(search: Search, best: Candidate, proposals: Iterable[Proposal], behind: float = CLOSE) -> list[Candidate]:
    """The proposals fitted, each given up where it must stay further behind the best set."""
    return search.try_proposals(list(proposals), ITERATIONS, give_up_above=best.fit.objective + behind)


def for_its_cost(search: Search, candidates: Sequence[Candidate]) -> Candidate:
    """The one of least chi^2 when every parameter that it makes use of has been paid for."""
    least = min(max(1.0, candidate.times_noise) for candidate in candidates)
    dear = parameter_cost(search.problem.count(), least)
    return min(candidates, key=lambda candidate: candidate.fit.objective + dear * parameters_used(candidate.fit))
