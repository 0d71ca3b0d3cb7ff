"""Two effects at once: what, on top of the best single ones, explains enough more."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from eha_core.diagnosis.facts import Facts
from eha_core.diagnosis.fit import Fit, fit
from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.problem import Problem
from eha_core.diagnosis.refine import Found, Progress, attempts, keep_better, settle, try_effect
from eha_core.diagnosis.screen import screen
from eha_core.diagnosis.tournament import ADEQUATE, Tournament, rank, scatter
from eha_core.effects import Effect

SECOND = 25.0

SECOND_SHARE = 0.004
IMPERFECT = 6e-4
CONVINCING = 0.5
"""A second effect must gain this in chi^2, and this share of the sample count, and this share of what the first
explains: a law that is right but for its smoothing, or for the timing of a break-away, leaves less. And it must explain
CONVINCING of what the first leaves over beside noise."""

MOST = 4
"""How many second effects are tried on each of the two best."""


def second_effects(
    problem: Problem,
    tournament: Tournament,
    candidates: Sequence[Effect],
    facts: Facts,
    progress: Progress = lambda _: None,
) -> Tournament:
    """Pairs: the best single effects with whatever, screened on top of them, promises enough more."""
    nominal = tournament.nominal.fit
    pairs: Found = []
    leader = tournament.entries[0] if tournament.entries else tournament.nominal
    explained = nominal.objective - leader.fit.objective
    threshold = tournament.scatter * (SECOND + SECOND_SHARE * problem.count()) + IMPERFECT * explained
    for entry in [one for one in tournament.entries[:2] if one.span is None]:
        if entry is not leader and not pairs and leader.fit.data < ADEQUATE * leader.fit.count:
            break  # the leader leaves nothing but noise, and nothing was found that it lacks
        # a pair must leave the leader behind, and one that adds the leader itself is screened from the leader's side
        needed = threshold + entry.fit.objective - leader.fit.objective
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
    singles = alone(problem, paired, [(entry.effects, entry.fit) for entry in tournament.entries])
    paired = [one for one in paired if _worth_two(one, singles, threshold)]
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


def _worth_two(pair: tuple[tuple[Effect, ...], Fit], singles: Found, threshold: float) -> bool:
    """Whether a pair leaves each of its members alone behind by what a second effect must earn."""
    effects, result = pair
    members = [one for kept, one in singles if len(kept) < len(effects) and set(kept) <= set(effects)]
    alone = min(members, key=lambda one: one.objective)
    gain = alone.objective - result.objective
    return gain > max(threshold, CONVINCING * (alone.data - alone.count))
