"""The search's course: from the best single effects to the set of which every member earns its place."""

from __future__ import annotations

from eha_core.diagnosis.criteria import FAR_FROM_NOISE, NEAR_NOISE, UNFITTED
from eha_core.diagnosis.search.candidates import Candidate, Search
from eha_core.diagnosis.search.exchange import exchange
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.joint_start import joint_start
from eha_core.diagnosis.search.prune import prune
from eha_core.diagnosis.search.short_windows import forms_of_friction, sticks

ROUNDS = 8
"""Exchanges at most; each has to make the fit better by more than chance would."""


def search_sets(search: Search, nominal: Candidate) -> Candidate:
    """The set of effects that explains the recording best and of which every member earns its place.

    Begins at the best that is there. Where what grows from it ends far from the noise, it has gone astray, and another
    set grows from what stands out of a joint fit; the better one goes on.
    """
    best = min(search, key=lambda one: one.fit.objective)
    if best.hypothesis.limited:
        return best
    if best.times_noise > FAR_FROM_NOISE or (best.times_noise > UNFITTED and sticks(best.hypothesis)):
        best = forms_of_friction(search, nominal)
    best = grow(search, best)
    if best.times_noise > FAR_FROM_NOISE:
        other = grow(search, joint_start(search, nominal))
        best = min(search.again(best), other, key=lambda one: one.fit.objective)
    for _ in range(ROUNDS):
        if best.times_noise < NEAR_NOISE or len(best.hypothesis.members) < 2:
            break
        better = exchange(search, best)
        if better.hypothesis == best.hypothesis:
            break
        search.report(better)
        best = grow(search, better)
    return prune(search, best)
