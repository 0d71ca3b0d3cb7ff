"""Stage 4b, name: the promising hypotheses refitted with every nominal parameter free, and compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.fit import Fit, fit, fit_in_stages
from eha_core.diagnosis.freedom import Free, effect_freedom
from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.problem import Problem
from eha_core.diagnosis.screen import Promise, one_each, scaled, screen
from eha_core.effects import Effect
from eha_core.parameters import NOMINAL

REFINED = 8
REFINED_FAR_OFF = 12
"""How many hypotheses are refitted in full after screening; more where the calibrated model is too far off to screen
well."""

ENOUGH = 20.0
"""An effect is named only if its score exceeds this: far beyond what the best of many hypotheses gains by chance."""

TIE = 10.0
"""Rivals within this of the best score are not told apart."""

SECOND = 25.0
SECOND_SHARE = 0.004
"""A second effect must score this, and this share of the sample count: a friction law's imperfect timing earns less."""

FAR_OFF = 5.0
"""Chi^2 a sample beyond which a calibration's parameter values mean little."""

SETTLED_LEADERS = 3
SETTLE_REACH = 300.0
"""The best few are fitted to their end, those at least that came within this of the best, or half of what it left
over."""

NOT_EXPLAINED = 1.03
"""Chi^2 a sample above which a leader is tried from another start."""

OUT_OF_REACH = 200.0
"""A hypothesis that cannot come within this of the best objective so far is not fitted to its end."""

ADEQUATE = 1.05
DEAR = 0.1
"""Where even the best model leaves more than ADEQUATE times the noise, its residual is no noise but more physics, and
small gains mean little: a parameter must then pay for itself by up to this share of what is left over."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Entry:
    """A hypothesis (no effect: the nominal model) with its fit. `score` is against the nominal model, in chi^2."""

    effects: tuple[Effect, ...]
    fit: Fit
    score: float

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the effects, in the catalogue's order."""
        return tuple(effect.id for effect in self.effects)


@dataclass(frozen=True)
class Tournament:
    """All that was refitted, the best first, the nominal model among them with score 0; and the screening's
    promises."""

    nominal: Entry
    entries: tuple[Entry, ...]
    promises: tuple[Promise, ...]
    scatter: float


def compete(
    problem: Problem, calibrated: Fit, candidates: Sequence[Effect], facts: Facts, progress: Progress = lambda _: None
) -> Tournament:
    """Screen every candidate, refit the best, then try pairs with the winners."""
    progress("screening the catalogue")
    promises = screen(problem, calibrated, [start for effect in candidates for start in starts(effect, facts)])
    far_off = calibrated.data > FAR_OFF * calibrated.count
    chosen = one_each(promises, REFINED_FAR_OFF if far_off else REFINED)
    found: list[tuple[tuple[Effect, ...], Fit]] = []
    best = calibrated.objective
    for promise in chosen:
        if promise.gain < ENOUGH:
            continue
        effect = promise.start.effect
        progress(f"refitting with {effect.id}")
        result = try_effect(problem, calibrated, promise, best)
        found.append(((effect,), result))
        best = min(best, result.objective)
    found = settle(problem, found, progress)
    nominal = back_fit(problem, calibrated, [result for _, result in found])
    entries = rank(problem, nominal, found)
    return Tournament(Entry((), nominal, 0.0), entries, promises, scatter(nominal, entries))


def try_effect(problem: Problem, base: Fit, promise: Promise, best: float) -> Fit:
    """Fit the promised effect on top of `base`, giving up when it cannot come near the `best` objective so far.

    A calibration that is far off has bent the nominal parameters to imitate what is missing: then the fit starts from
    their nominal values, and from the start's own size.
    """
    effect = promise.start.effect
    if base.data > FAR_OFF * base.count:
        untouched = {one.name: one.reference for one in base.free if one.name in {row.name for row in NOMINAL}}
        values = {**base.values, **untouched, **promise.start.values}
        free = _with_effect(base.free, effect, values)
        return fit_in_stages(problem, values, free, give_up_above=best + OUT_OF_REACH)
    values = {**base.values, **scaled(promise)}
    free = _with_effect(base.free, effect, values)
    return fit(problem, values, free, base.states, iterations=25, give_up_above=best + OUT_OF_REACH)


def _with_effect(free: tuple[Free, ...], effect: Effect, values: Mapping[str, float]) -> tuple[Free, ...]:
    extra = effect_freedom(effect, values)
    return (*(one for one in free if one.name not in {own.name for own in extra}), *extra)


Found = list[tuple[tuple[Effect, ...], Fit]]


def settle(problem: Problem, found: Found, progress: Progress = lambda _: None) -> Found:
    """The leaders fitted to their end: with derivatives at the full step, and from more than one start where it may
    matter.

    A search from a calibration that is far off can leave the nominal parameters in a valley of their own.
    """
    order = sorted(range(len(found)), key=lambda place: found[place][1].objective)
    exact = replace(problem, slope_step=problem.shooting.step_size)
    best = np.inf
    settled = list(found)
    for place in order[:SETTLED_LEADERS]:
        effects, result = found[place]
        if result.objective > best + 0.5 * max(best - problem.count(), 0.0) + SETTLE_REACH:
            continue
        progress(f"settling {' and '.join(effect.id for effect in effects)}")
        result = fit(exact, result.values, result.free, result.states, iterations=30)
        if result.data > NOT_EXPLAINED * result.count:
            untouched = {one.name: one.reference for one in result.free if one.name in {row.name for row in NOMINAL}}
            again = fit(problem, {**result.values, **untouched}, result.free, None, iterations=15)
            if again.objective < result.objective:
                result = fit(exact, again.values, again.free, again.states, iterations=6)
        result = _other_instants(problem, result)
        best = min(best, result.objective)
        settled[place] = (effects, result)
    return settled


def _other_instants(problem: Problem, result: Fit) -> Fit:
    """An instant that a fit moves can rest beside the right one: try its surroundings."""
    for one in result.free:
        if one.resolution == 0.0:
            continue
        for shift in (-0.12, -0.04, 0.04, 0.12):
            moved = {**result.values, one.name: result.values[one.name] + shift}
            again = fit(problem, moved, result.free, result.states, iterations=4)
            if again.objective < result.objective:
                result = again
    return result


def back_fit(problem: Problem, calibrated: Fit, others: Sequence[Fit]) -> Fit:
    """The nominal model fitted once more from the best hypothesis' nominal values.

    A nominal fit that stopped in a flat valley would make any hypothesis that left it look like a discovery.
    """
    if not others:
        return calibrated
    best = min(others, key=lambda one: one.objective)
    names = {one.name for one in calibrated.free}
    values = {name: best.values[name] if name in names else value for name, value in calibrated.values.items()}
    again = fit(problem, values, calibrated.free, best.states)
    return again if again.objective < calibrated.objective else calibrated


def scatter(nominal: Fit, entries: Sequence[Entry]) -> float:
    """Variance of the residual in units of the assumed noise, under the best model and never below one."""
    best = min([nominal, *(entry.fit for entry in entries)], key=lambda one: one.objective)
    return max(1.0, best.data / best.count)


def parameter_cost(count: int, left_over: float) -> float:
    """What a hypothesis pays for each of its parameters, where the best model leaves `left_over` chi^2 a sample."""
    return log(count) + DEAR * count * max(0.0, 1.0 - ADEQUATE / left_over)


def rank(problem: Problem, nominal: Fit, found: Sequence[tuple[tuple[Effect, ...], Fit]]) -> tuple[Entry, ...]:
    """Scores: the gain over the nominal model in units of the residual's variance, less the cost of its parameters."""
    best = min([nominal, *(result for _, result in found)], key=lambda one: one.objective)
    variance = max(1.0, best.data / best.count)
    entries = []
    for effects, result in found:
        count = sum(len(effect.parameters) for effect in effects)
        gain = (nominal.objective - result.objective) / variance
        entries.append(Entry(effects, result, gain - count * parameter_cost(problem.count(), variance)))
    return tuple(sorted(entries, key=lambda entry: -entry.score))


def second_effects(
    problem: Problem,
    tournament: Tournament,
    candidates: Sequence[Effect],
    facts: Facts,
    progress: Progress = lambda _: None,
) -> Tournament:
    """Pairs: the best single effects with whatever, screened on top of them, promises enough more."""
    nominal = tournament.nominal.fit
    pairs: dict[tuple[str, ...], tuple[tuple[Effect, ...], Fit]] = {}
    threshold = tournament.scatter * (SECOND + SECOND_SHARE * problem.count())
    leader = tournament.entries[0] if tournament.entries else tournament.nominal
    for entry in tournament.entries[:2]:
        rest = [effect for effect in candidates if effect.id not in entry.ids]
        promises = screen(problem, entry.fit, [start for effect in rest for start in starts(effect, facts)])
        for promise in one_each(promises, 4):
            # a pair must leave the leader behind, and one that adds the leader itself is screened from the leader's
            # side
            behind = entry.fit.objective - leader.fit.objective
            if promise.gain < threshold + behind or (entry is not leader and promise.start.effect.id in leader.ids):
                continue
            both = tuple(sorted((*entry.effects, promise.start.effect), key=lambda effect: effect.id))
            key = tuple(effect.id for effect in both)
            if key in pairs:
                continue
            progress(f"refitting with {' and '.join(key)}")
            best = min([entry.fit.objective, *(result.objective for _, result in pairs.values())])
            pairs[key] = (both, try_effect(problem, entry.fit, promise, best))
    paired = settle(problem, list(pairs.values()), progress)
    entries = rank(problem, nominal, [*paired, *((entry.effects, entry.fit) for entry in tournament.entries)])
    return replace(tournament, entries=entries, scatter=scatter(nominal, entries))


def bounded(entry: Entry) -> bool:
    """Whether an effect's size stands at a bound or at nothing: then it explains nothing of its own."""
    for effect in entry.effects:
        for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
            if row.switches and np.isclose(
                entry.fit.values[name], row.nominal, atol=1e-12 * max(1.0, abs(row.typical))
            ):
                return True
    return False
