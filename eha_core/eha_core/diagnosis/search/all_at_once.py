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

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import FAR_FROM_NOISE, chance_gain
from eha_core.diagnosis.effect_parameters import free_effect_parameters
from eha_core.diagnosis.hypothesis import NOTHING, neutral
from eha_core.diagnosis.search.candidates import Candidate, Search, without_effect
from eha_core.diagnosis.search.short_windows import STICKING, at_nominal, first_guess
from eha_core.effects import Effect
from eha_core.identification.fit import Fit, fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.numbers import Array
from eha_core.identification.per_recording import base_name
from eha_core.identification.problem import whole
from eha_core.identification.short_windows import held, starts, with_finer_slopes

BEGIN = 0.1
"""Share of its first guess at which each effect begins: all at full size would be far from any rig (assumed)."""

ITERATIONS = 15
"""Of the fit of all effects over each length of the windows, and of each fit with fewer."""


def all_at_once(search: Search, nominal: Candidate) -> Candidate:
    """The best so far when all effects were fitted together from nominal values, and those left out that are not
    needed."""
    effects = found_by_a_fit(search.applicable)
    search.progress(f"fitting {len(effects)} effects together, from short windows to long ones")
    small, free = _small(effects, search.scales)
    plant = nominal.fit.free
    short, *longer = map(whole, search.shorter)
    values = {**at_nominal(nominal.fit.values, plant), **small}
    begun = fit(short, values, held((*plant, *free), values), starts(short, values), iterations=ITERATIONS)
    values = dict(begun.values)
    for problem in (short, *longer, search.problem):
        together = fit(problem, values, (*plant, *free), starts(problem, values), iterations=ITERATIONS)
        values = dict(together.values)
        if together.data > FAR_FROM_NOISE * together.count:
            search.progress(f"{together.data / together.count:.3g} times the noise's energy is left by all together")
            break
    else:
        search.report(_fewest(search, Candidate(NOTHING.with_effects(effects), together)))
    return search.best


def found_by_a_fit(applicable: Sequence[Effect]) -> list[Effect]:
    """The effects that derivatives lead to: an instant has to be looked for. The form of dry friction with most
    parameters, of those without a memory, represents all."""
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
            replace(parameter, reference=off[parameter.name])
            if parameter.name in off and not parameter.above
            else parameter
            for parameter in free_effect_parameters(effect, guess)
        ]
        values |= {**guess, **{name: nothing + BEGIN * (guess[name] - nothing) for name, nothing in off.items()}}
    return values, tuple(free)


def _fewest(search: Search, together: Candidate) -> Candidate:
    """The set without the effects that it does not need, fitted again; fewer at a time where the curvature promised
    what the fit without them does not keep."""
    at, needed = together, chance_gain(together.fit.count, together.times_noise)
    most = len(at.hypothesis.members)
    while gone := not_needed(at.fit, at.hypothesis.effects, needed)[:most]:
        values, free = dict(at.fit.values), at.fit.free
        for effect in gone:
            values, free = without_effect(replace(at.fit, values=values, free=free), effect)
        worst = at.fit.objective + len(gone) * needed
        result = fit(search.problem, values, free, at.fit.states, iterations=ITERATIONS, give_up_above=worst)
        if result.objective < worst:
            at = Candidate(NOTHING.with_effects(kept for kept in at.hypothesis.effects if kept not in gone), result)
        elif len(gone) > 1:
            most = len(gone) // 2
        else:
            break
    finer = with_finer_slopes(search.problem)
    return search.keep(at.hypothesis, fit(finer, at.fit.values, at.fit.free, at.fit.states))


def not_needed(result: Fit, effects: Sequence[Effect], needed: float) -> list[Effect]:
    """Up to half of the effects, one by one what the rest compensates for best at a cost of less than `needed`.

    The cost is that of the curvature at the fit, which holds near it.
    """
    count = len(result.q)
    away, covariance = _away_from_nothing(result, effects), result.covariance[:count, :count].copy()
    places = {effect: _sizes(result, effect) for effect in effects}
    gone: list[Effect] = []
    while len(gone) < (len(effects) + 1) // 2:
        costs = {effect: _cost(away, covariance, at) for effect, at in places.items() if effect not in gone}
        least = min(costs, key=lambda effect: costs[effect])
        if costs[least] > needed:
            break
        at = places[least]
        follow = covariance[:, at] @ np.linalg.pinv(covariance[np.ix_(at, at)], hermitian=True)
        away -= follow @ away[at]
        covariance -= follow @ covariance[at]
        gone.append(least)
    return gone


def _sizes(result: Fit, effect: Effect) -> list[int]:
    """Where the fit's coordinates have the sizes that turn an effect on."""
    names = {f"{effect.id}.{row.name}" for row in effect.parameters if row.switches and not row.above}
    return [place for place, parameter in enumerate(result.free) if base_name(parameter.name) in names]


def _away_from_nothing(result: Fit, effects: Sequence[Effect]) -> Array:
    """The fit's coordinates, of the effects' sizes counted from where they are nothing."""
    off = {name: value for effect in effects for name, value in neutral(effect).items()}
    nothing = [
        parameter.coordinate(off.get(base_name(parameter.name), parameter.reference)) for parameter in result.free
    ]
    away: Array = result.q - np.array(nothing)
    return away


def _cost(away: Array, covariance: Array, at: Sequence[int]) -> float:
    """Chi^2 that setting these coordinates to nothing costs when all others follow."""
    return float(away[at] @ np.linalg.pinv(covariance[np.ix_(at, at)], hermitian=True) @ away[at])
