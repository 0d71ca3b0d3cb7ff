"""All at once: every effect that a fit can find is fitted together, and then the fewest that explain as much.

A set that grows effect by effect begins with whatever makes up best for all that is missing, and that may be no effect
of the rig. Fitted together, effects need not stand for each other. Each begins at a small share of its first guess,
over short windows, where what is still wrong does not carry far; those that the fit can do without are then left out,
by its curvature and with a new fit after each half of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.calibrate import STEPS
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import FAR_FROM_NOISE, MOST_EFFECTS, chance_gain
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.candidates import Candidate, Search, without_effect
from eha_core.diagnosis.search.short_windows import STICKING, at_nominal, first_guess
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.problem import whole
from eha_core.identification.segments import coarser
from eha_core.identification.short_windows import starts

BEGIN = 0.1
"""Share of its first guess at which each effect begins: all at full size would be far from any rig (assumed)."""

ITERATIONS = 15
"""Of the fit of all effects over each length of the windows, and of each fit with fewer."""

SHORTEST = 1
"""The first of the search's `shorter` windows that are used: over 0.05 s hardly anything but speeds and pressures is
told, and so many effects have no hold."""

HELD = 0.2
"""Share of its prior deviation within which a nominal parameter is believed while the effects come to their sizes. Of
nine development rigs with the widest gaps (seed 61331) four came nearer to the noise than with all of it, none stayed
further off by much."""


def all_at_once(search: Search, nominal: Candidate) -> Candidate:
    """The best so far when all effects were fitted together from nominal values, and those left out that are not
    needed."""
    effects = found_by_a_fit(search.applicable)
    search.progress(f"fitting {len(effects)} effects together, from short windows to long ones")
    values, free = _small(effects, search.scales)
    plant = nominal.fit.free
    values = {**at_nominal(nominal.fit.values, plant), **values}
    held = tuple(replace(one, prior_deviation=HELD * one.prior_deviation) for one in plant)
    short, *longer = (whole(coarser(shooting, STEPS[0])) for shooting in search.shorter[SHORTEST:])
    for problem, nominal_free in ((short, held), *((one, plant) for one in (short, *longer, search.problem))):
        together = fit(problem, values, (*nominal_free, *free), starts(problem, values), iterations=ITERATIONS)
        if nominal_free is plant and together.data > FAR_FROM_NOISE * together.count:
            search.progress(f"{together.data / together.count:.3g} times the noise's energy is left by all together")
            break
        values = dict(together.values)
    else:
        search.report(_fewest(search, Candidate(NOTHING.with_effects(effects), together)))
    return min(search, key=lambda one: one.fit.objective)


def found_by_a_fit(applicable: Sequence[Effect]) -> list[Effect]:
    """The effects that derivatives lead to: an instant or a place has to be looked for. The form of dry friction with
    most parameters, of those without a memory, stands for all."""
    forms = [effect for effect in applicable if effect.kind == STICKING and not effect.memory]
    richest = max(forms, key=lambda effect: len(effect.parameters), default=None)
    return [
        effect
        for effect in applicable
        if not any(row.relative_to == "time" for row in effect.parameters)
        and (effect.kind != STICKING or effect is richest)
    ]


def _small(effects: Sequence[Effect], scales: Scales) -> tuple[dict[str, float], tuple[FreeParameter, ...]]:
    """The effects at BEGIN of their first guesses; free in units of these, and believed to be nothing."""
    values: dict[str, float] = {}
    free: list[FreeParameter] = []
    for effect in effects:
        guess = first_guess(effect, scales)
        rows = zip(effect.parameter_names(), effect.parameters, strict=True)
        off = {name: row.nominal for name, row in rows if row.switches}
        free += [
            replace(one, reference=off[one.name]) if one.name in off and not one.above else one
            for one in free_effect_parameters(effect, guess)
        ]
        values |= {**guess, **{name: nothing + BEGIN * (guess[name] - nothing) for name, nothing in off.items()}}
    return values, tuple(free)


def _fewest(search: Search, candidate: Candidate) -> Candidate:
    """The set without the effects that it does not need, MOST_EFFECTS at most, fitted again."""
    while True:
        needed = chance_gain(candidate.fit.count, candidate.times_noise)
        gone = not_needed(candidate.fit, candidate.hypothesis.effects, needed)
        if not gone:
            return search.keep(candidate.hypothesis, candidate.fit)
        values, free = dict(candidate.fit.values), candidate.fit.free
        for effect in gone:
            values, free = without_effect(replace(candidate.fit, values=values, free=free), effect)
        rest = NOTHING.with_effects(one for one in candidate.hypothesis.effects if one not in gone)
        candidate = Candidate(rest, fit(search.problem, values, free, candidate.fit.states, iterations=ITERATIONS))


def not_needed(result: Fit, effects: Sequence[Effect], needed: float) -> list[Effect]:
    """Up to half of the effects, one after the other what the rest makes up for best at a cost of less than `needed`.

    The cost is that of the curvature at the fit, which holds near it; where there are more than MOST_EFFECTS, it may be
    any.
    """
    q, count = result.q.copy(), len(result.q)
    covariance = result.covariance[:count, :count].copy()
    places = {effect: _sizes(result, effect) for effect in effects}
    gone: list[Effect] = []
    while len(gone) < (len(effects) + 1) // 2:
        costs = {one: _cost(q, covariance, at) for one, at in places.items() if one not in gone}
        least = min(costs, key=lambda one: costs[one])
        if costs[least] > needed and len(costs) <= MOST_EFFECTS:
            break
        at = places[least]
        follow = covariance[:, at] @ np.linalg.pinv(covariance[np.ix_(at, at)], hermitian=True)
        q -= follow @ q[at]
        covariance -= follow @ covariance[at]
        gone.append(least)
    return gone


def _sizes(result: Fit, effect: Effect) -> list[int]:
    """Where the fit's coordinates have the sizes that turn an effect on; each is nothing at the coordinate 0."""
    names = {f"{effect.id}.{row.name}" for row in effect.parameters if row.switches and not row.above}
    return [place for place, one in enumerate(result.free) if one.name in names]


def _cost(q: Array, covariance: Array, at: Sequence[int]) -> float:
    """Chi^2 that setting these coordinates to nothing costs when all others follow."""
    return float(q[at] @ np.linalg.pinv(covariance[np.ix_(at, at)], hermitian=True) @ q[at])
