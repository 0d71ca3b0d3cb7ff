"""The search's course: from the best single effects to the set of which every member is significant."""

from __future__ import annotations

from eha_core.diagnosis.criteria import FAR_FROM_NOISE, NEAR_NOISE, UNFITTED
from eha_core.diagnosis.search.all_at_once import all_at_once
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.converge import converge
from eha_core.diagnosis.search.exchange import exchange
from eha_core.diagnosis.search.grow import grow, try_for_a_while
from eha_core.diagnosis.search.over_short_windows import grown_over_short_windows
from eha_core.diagnosis.search.proposals import guesses_beside
from eha_core.diagnosis.search.prune import prune
from eha_core.diagnosis.search.screening import screen_in_time
from eha_core.diagnosis.search.short_windows import forms_of_friction, set_in_each_form, sticks
from eha_core.diagnosis.search.simpler_form import from_a_simpler_form

SINGLES = 4
"""How many of the best single effects are asked whether another acts over an interval beside them."""

ROUNDS = 8
"""Exchanges at most; each has to make the fit better by more than chance would."""


def beside_the_singles(search: Search) -> Candidate:
    """The best so far when an effect that acts over an interval was looked for beside each of the best single effects.

    Such an effect bends what is fitted without it, and the best single effect may be one that the rig does not have.
    """
    singles = sorted(
        (candidate for candidate in search if len(candidate.hypothesis.members) == 1),
        key=lambda candidate: candidate.fit.objective,
    )
    for single in singles[:SINGLES]:
        if not single.hypothesis.limited and any(parameter.resolution > 0.0 for parameter in single.fit.free):
            # what sets in at an instant explains little beside the right one, and another over an interval seems better
            converged = converge(search.problem, {single.hypothesis: single.fit}, search.progress)
            search.keep(single.hypothesis, converged[single.hypothesis])
    best = search.best
    if best.times_noise < NEAR_NOISE:
        return best
    for single in map(search.again, singles[1:SINGLES]):  # beside the first it is looked for when the set grows
        try_for_a_while(search, single, screen_in_time(search.problem, single.fit, guesses_beside(search, single)))
    return search.best


def search_sets(search: Search, nominal: Candidate) -> Candidate:
    """The set of effects that explains the recording best and of which every member is significant.

    Begins at the best single effect. Where it ends with more than noise left, it may have begun wrongly, its dry
    friction may have another form, or a member another's place.
    """
    best = search.best
    if best.hypothesis.limited and not NEAR_NOISE < best.times_noise < FAR_FROM_NOISE:
        return best  # it explains all, or led the single effects and hardly explains anything
    if search.leaves(best, NEAR_NOISE):
        best = beside_the_singles(search)
    if search.leaves(best, UNFITTED):
        best = grown_over_short_windows(search, nominal)
    if search.leaves(best, UNFITTED) and sticks(best.hypothesis):
        best = forms_of_friction(search, nominal)
    best = grow(search, best)
    if search.leaves(best, UNFITTED):
        best = grow(search, all_at_once(search, nominal))
    if search.leaves(best, NEAR_NOISE) and sticks(best.hypothesis):
        best = grow(search, set_in_each_form(search, best))
    for _ in range(ROUNDS):
        if not search.leaves(best, NEAR_NOISE) or len(best.hypothesis.members) < 2:
            break
        better = exchange(search, best)
        if better.hypothesis == best.hypothesis:
            break
        search.report(better)
        best = grow(search, better)
    return prune(search, from_a_simpler_form(search, best))
