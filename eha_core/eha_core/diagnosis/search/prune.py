"""Prune: drop what does not earn its place beside the other members."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.criteria import (
    CHANCE,
    CONVINCING,
    FURTHER,
    LOOKED_AT,
    NOISE_KNOWN,
    OF_ITS_FORM,
    OF_SAMPLES,
    OF_SAMPLES_BESIDE_A_FORM,
    OVER,
)
from eha_core.diagnosis.hypothesis import NOTHING, Member, neutral
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search, without_effect
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.per_recording import base_name, is_one_of

AT_MOST = 30
"""Iterations for which such a fit goes on at most."""

STEPS_OUT = (0.75, 0.5, 0.25)
"""Shares of its sizes at which a member is held one after the other on its way out, ..."""

ON_THE_WAY = 4
"""... and the iterations at each. The parameters that can make up for it follow it along their valley; taken out at
once, a scale of both pressures stayed 2,541 chi^2 above the rig without it (development case rig-0013, seed 61331)."""


def wald(result: Fit, effect: Effect) -> float:
    """What dropping an effect would cost in chi^2, as the curvature at the fit has it."""
    off = neutral(effect)
    switches = {f"{effect.id}.{row.name}" for row in effect.parameters if row.switches}
    names = [parameter.name for parameter in result.free if is_one_of(parameter.name, switches)]
    if not names:
        return 0.0
    distance = np.array([result.values[name] - off[base_name(name)] for name in names])
    block = result.covariance_of(names)
    scale = np.sqrt(np.maximum(np.diag(block), 1e-300))  # names differ by their unit
    correlation = np.linalg.pinv(block / np.outer(scale, scale), hermitian=True)
    return float(distance / scale @ correlation @ (distance / scale))


def refit_without(search: Search, candidate: Candidate, member: Member, iterations: int = FURTHER) -> Candidate:
    """The set without one member, fitted from where the whole set stands."""
    return search.try_proposal(_without(candidate, member), iterations)


def _without(candidate: Candidate, member: Member) -> Proposal:
    values, free = without_effect(candidate.fit, member.effect)
    return Proposal(candidate.hypothesis.without(member), values, free, candidate.fit.states)


def refit_gradually(search: Search, candidate: Candidate, member: Member) -> Candidate:
    """The set without one member, which is taken out little by little."""
    at, (values, free) = candidate.fit, without_effect(candidate.fit, member.effect)
    sizes = {f"{member.id}.{row.name}": row.nominal for row in member.effect.parameters if row.switches}
    states = at.states
    for share in STEPS_OUT:
        held = {
            name: sizes[base_name(name)] + share * (value - sizes[base_name(name)])
            for name, value in at.values.items()
            if base_name(name) in sizes
        }
        shapes = {name: value for name, value in at.values.items() if is_one_of(name, member.effect.parameter_names())}
        step = fit(search.problem, {**values, **shapes, **held}, free, states, iterations=ON_THE_WAY)
        values, states = {**values, **{parameter.name: step.values[parameter.name] for parameter in free}}, step.states
    proposal = Proposal(candidate.hypothesis.without(member), values, free, states)
    return search.try_proposal(proposal, FURTHER)


def look_back(search: Search, candidate: Candidate, needed: float) -> Candidate:
    """The set without the members that it no longer needs, by the curvature and a refit that confirms it."""
    while len(candidate.hypothesis.members) > 1:
        costs = {member: wald(candidate.fit, member.effect) for member in candidate.hypothesis.members}
        least = min(costs, key=lambda member: costs[member])
        if costs[least] > LOOKED_AT * needed:
            break
        simpler = refit_without(search, candidate, least)
        if simpler.fit.objective - candidate.fit.objective > needed:
            break
        candidate = simpler
    return candidate


def prune(search: Search, best: Candidate) -> Candidate:
    """The set without the members that do not earn their place beside the others, by what a refit without each loses.

    A refit that loses much goes on while it may come near enough; until it converges where the curvature says that it
    will: where many parameters change together, such as all pressures' scale, that takes many iterations.
    """
    while len(best.hypothesis.members) > 1:
        members = best.hypothesis.members
        refitted = search.try_proposals([_without(best, member) for member in members], FURTHER)
        simpler = dict(zip(members, refitted, strict=True))
        predicted = {member: wald(best.fit, member.effect) for member in simpler}
        worth = {member: min(_lost(candidate, best), predicted[member]) for member, candidate in simpler.items()}
        explained = search.found[NOTHING].objective - best.fit.objective
        asked = {member: asked_of(member, worth, best, explained) for member in simpler}
        for member in simpler:
            if _lost(simpler[member], best) > asked[member]:
                near = predicted[member] < LOOKED_AT * asked[member]
                enough = np.inf if near else best.fit.objective + asked[member]
                simpler[member] = search.go_on(simpler[member], AT_MOST, give_up_above=enough)
            if max(asked[member], predicted[member]) < _lost(simpler[member], best) < OVER * explained:
                simpler[member] = refit_gradually(search, best, member)
        lost = {member: _lost(candidate, best) for member, candidate in simpler.items()}
        least = min(lost, key=lambda member: lost[member] / asked[member])
        search.progress(f"chi^2 lost without: {', '.join(f'{member.id} {loss:.3g}' for member, loss in lost.items())}")
        if lost[least] > asked[least]:
            break
        best = simpler[least]
    return best


def _lost(without: Candidate, best: Candidate) -> float:
    return without.fit.objective - best.fit.objective


def by_chance(member: Member, worth: Mapping[Member, float], best: Candidate) -> float:
    """Chi^2 that a member may be worth beside the others by chance.

    Beside a law of several forms a refit may stop short, for friction makes the objective rugged: there a small loss
    is believed where the curvature confirms it.
    """
    louder = max(1.0, best.times_noise)
    least = louder * (CHANCE + OF_SAMPLES * best.fit.count)
    if worth[member] > least or not any(other.effect.approximate for other in worth if other != member):
        return least
    return louder * (CHANCE + OF_SAMPLES_BESIDE_A_FORM * best.fit.count)


def asked_of(member: Member, worth: Mapping[Member, float], best: Candidate, explained: float) -> float:
    """Chi^2 that a member must be worth beside the others, which are worth so much each, and `explained` together.

    It rises with what the set leaves unexplained: a law of another form always leaves something for others that act in
    the same equation.
    """
    beside = [other for other in worth if other != member and other.effect.approximate and meet(member, other)]
    forms = [worth[other] for other in beside]
    left = max(best.fit.data - best.fit.count, 0.0)
    their_forms = OF_ITS_FORM * min(sum(max(gain, 0.0) for gain in forms), max(explained, 0.0))
    ratio = CONVINCING / (1.0 - CONVINCING)
    # what compensates for a form leaves some of it over, too, beyond what may pass for noise
    their_forms = min(their_forms, ratio * (left + NOISE_KNOWN * best.fit.count))
    return max(by_chance(member, worth, best) + their_forms, ratio * max(left - NOISE_KNOWN * best.fit.count, 0.0))


def meet(member: Member, other: Member) -> bool:
    """Whether two effects act in one equation, of the piston's forces or of the oil's flow; a sensor shows both."""
    sites = (member.effect.site, other.effect.site)
    return any(site in ("sensor", "schedule") for site in sites) or (sites[0] == "force") == (sites[1] == "force")
