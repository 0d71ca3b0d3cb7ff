"""Two effects at once: what, on top of the best single ones, explains enough more."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.fit import Fit, fit
from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.problem import Problem
from eha_core.diagnosis.refine import Found, Progress, attempts, keep_better, settle, try_effect
from eha_core.diagnosis.screen import screen
from eha_core.diagnosis.tournament import ADEQUATE, Entry, Tournament, rank, scatter
from eha_core.effects import Effect

SECOND = 25.0
"""A second effect must gain this in chi^2 ..."""

OF_SAMPLES = {False: 0.001, True: 0.004}
OF_EXPLAINED = {False: 1e-6, True: 6e-4}
"""... and these shares of the sample count and of what the first explains: what is left by another step of integration,
and (True) by a law that is right but for its form, its smoothing, or the timing of a break-away ..."""

CONVINCING = 0.4
"""... and explain this share of what the first leaves over beside noise."""

MOST = 4
"""How many second effects are tried on each of the two best."""


def second_effects(
    problem: Problem,
    tournament: Tournament,
    candidates: Sequence[Effect],
    facts: Facts,
    progress: Progress = lambda _: None,
) -> Tournament:
    """Pairs: the best single effects with whatever, screened on top of them, promises enough more.

    A pair can lead to a better single effect than there was; that one is then looked at in the same way.
    """
    leaders = tournament.entries[:2]
    tournament = _beside(problem, tournament, leaders, candidates, facts, progress)
    singles = [entry for entry in tournament.entries if len(entry.effects) == 1]
    tried = [entry.effects for entry in leaders]
    if singles and singles[0].effects not in tried and singles[0].fit.data > ADEQUATE * singles[0].fit.count:
        tournament = _beside(problem, tournament, singles[:1], candidates, facts, progress)
    return tournament


def _beside(
    problem: Problem,
    tournament: Tournament,
    leaders: Sequence[Entry],
    candidates: Sequence[Effect],
    facts: Facts,
    progress: Progress,
) -> Tournament:
    """The tournament with the pairs that hold one of the leaders, single effects of which the first explains most."""
    nominal = tournament.nominal.fit
    leader = leaders[0] if leaders else tournament.nominal
    explained = nominal.objective - leader.fit.objective

    def earning(first: Sequence[Effect]) -> float:
        approximate = any(effect.approximate for effect in first)
        chance = tournament.scatter * (SECOND + OF_SAMPLES[approximate] * problem.count())
        return chance + OF_EXPLAINED[approximate] * explained

    pairs: Found = []
    for entry in [one for one in leaders if one.span is None]:
        if entry is not leader and not pairs and leader.fit.data < ADEQUATE * leader.fit.count:
            break  # the leader leaves nothing but noise, and nothing was found that it lacks
        # a pair must leave the leader behind, and one that adds the leader itself is screened from the leader's side
        needed = earning(entry.effects) + entry.fit.objective - leader.fit.objective
        others = {*entry.ids, *(() if entry is leader else leader.ids)}
        kinds = {effect.kind for effect in entry.effects if effect.kind}
        able = [effect for effect in candidates if effect.id not in others and effect.kind not in kinds]
        beginnings = [start for effect in able for start in starts(effect, facts)]
        promises = screen(problem, entry.fit, beginnings)
        for attempt in attempts(problem, entry.fit, beginnings, promises, MOST, needed):
            both = tuple(sorted((*entry.effects, attempt.promise.start.effect), key=lambda effect: effect.id))
            if not attempt.afresh and any(both == pair for pair, _ in pairs):
                continue
            progress(f"refitting with {' and '.join(effect.id for effect in both)}")
            best = min([entry.fit.objective, *(result.objective for _, result in pairs)])
            keep_better(pairs, both, try_effect(problem, attempt, best))
    paired = settle(problem, pairs, progress)
    before = [(entry.effects, entry.fit) for entry in tournament.entries]
    singles = alone(problem, paired, [one for one in before if len(one[0]) == 1])
    for effects, result in [one for one in before if len(one[0]) == 2]:
        keep_better(paired, effects, result)
    paired = [one for one in paired if _worth_two(one, singles, earning)]
    entries = rank(problem, nominal, [*paired, *singles])
    return replace(tournament, entries=entries, scatter=scatter(nominal, entries))


def alone(problem: Problem, paired: Found, singles: Found) -> Found:
    """The single hypotheses, those that the best pair is made of fitted once more from where it stands, each alone.

    A single fit that stopped short would make any second effect that led it on look like a discovery.
    """
    if not paired:
        return singles
    effects, best = min(paired, key=lambda one: one[1].objective)
    found = list(singles)
    for dropped in effects:
        kept = tuple(effect for effect in effects if effect is not dropped)
        names = set(dropped.parameter_names())
        neutral = {name: row.nominal for name, row in zip(dropped.parameter_names(), dropped.parameters, strict=True)}
        free = [one for one in best.free if one.name not in names]
        keep_better(found, kept, fit(problem, {**best.values, **neutral}, free, best.states, iterations=25))
    return found


def _worth_two(
    pair: tuple[tuple[Effect, ...], Fit], singles: Found, earning: Callable[[Sequence[Effect]], float]
) -> bool:
    """Whether a pair leaves its members alone, and whatever explains most alone, behind by what a second effect must
    earn beside it."""
    effects, result = pair
    members = [one for one in singles if set(one[0]) <= set(effects)]

    def earned(first: tuple[tuple[Effect, ...], Fit]) -> bool:
        kept, simpler = first
        gain = simpler.objective - result.objective
        return gain > max(earning(kept), CONVINCING * (simpler.data - simpler.count))

    return all(earned(min(some, key=lambda one: one[1].objective)) for some in (members, singles))
