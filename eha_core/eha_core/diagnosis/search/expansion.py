"""One search over whole sets: propose from the quadratic model, fit what is proposed, go on from the best of all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from eha_core.diagnosis.calibrate import is_at_noise
from eha_core.diagnosis.criteria import (
    ADDED,
    EXPANSIONS,
    FITTED,
    IDLE,
    IMPROVES,
    MOST_TRIED,
    OF_EXCESS,
    OF_SIZE,
    RELATED,
    SHARES,
    TO_THE_END,
    TRIED,
    TRIED_AT_THE_NOISE,
    chance_gain,
)
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.search.best_sets import Proposal, best_sets
from eha_core.diagnosis.search.columns import Column
from eha_core.diagnosis.search.pool import Pool, Progress
from eha_core.diagnosis.search.quadratic import QuadraticModel, with_columns
from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.problem import objectives_at


def required(result: Fit) -> float:
    """Chi^2 that a member has to gain together with the others of a set that leaves what `result` does."""
    by_chance = chance_gain(result.count, result.data / result.count)
    return by_chance + OF_EXCESS * max(0.0, result.objective - result.count)


def cost(hypothesis: Hypothesis, result: Fit) -> float:
    """What sets are compared by while the search goes on: chi^2, and what its members have to gain at least."""
    return result.objective + hypothesis.size * chance_gain(result.count, result.data / result.count)


def leader(pool: Pool) -> Hypothesis:
    """The best of all sets that were fitted."""
    return min(pool.found, key=lambda hypothesis: cost(hypothesis, pool.found[hypothesis]))


@dataclass
class Search:
    """A search over windows of one length: its pool, what can be added, when it is content before the noise is reached,
    and the sets that it has gone on from."""

    pool: Pool
    columns: Sequence[Column]
    say: Progress = lambda _: None
    content: Callable[[Pool], bool] = lambda _: False
    expanded: dict[Hypothesis, float] = field(default_factory=dict)

    def next(self) -> Hypothesis | None:
        """The best set that the search has not gone on from yet; None where there is nothing more to do."""
        lead = leader(self.pool)
        if lead not in self.expanded:
            return lead
        result = self.pool.found[lead]
        if result.objective < self.expanded[lead] - required(result):
            return lead
        if self.pool.leaves_noise(lead):
            return None
        within = RELATED * cost(lead, result)
        rest = [h for h, at in self.pool if h not in self.expanded and cost(h, at) < within]
        return min(rest, key=lambda h: cost(h, self.pool.found[h]), default=None)


def search_sets(search: Search) -> Hypothesis:
    """The best set over the pool's windows; every set that was fitted stays in the pool."""
    pool, idle = search.pool, 0
    for number in range(EXPANSIONS):
        base = search.next()
        if base is None or idle == IDLE or search.content(pool):
            break
        before = pool.found[leader(pool)]
        expand(search, base, f"expansion {number + 1}")
        pool.release(leader(pool))
        after = pool.found[leader(pool)]
        worthwhile = max(required(after), IMPROVES * (before.objective - before.count))
        idle = idle + 1 if before.objective - after.objective < worthwhile else 0
    return leader(pool)


def expand(search: Search, base: Hypothesis, step: str, at: Fit | None = None) -> None:
    """Linearise about a set, at its best fit unless another is given, and fit the best sets that follow from it."""
    pool, lead = search.pool, leader(search.pool)
    at = pool.found[base] if at is None else at
    search.expanded[base] = at.objective
    addable = [c for c in search.columns if c.effect.id not in base.ids and c.effect.kind not in base.kinds]
    in_time = base in (lead, NOTHING) and not base.limited
    model = with_columns(pool.about(base, at), base, addable, in_time)
    tried = 0
    near: Hypothesis | None = None
    for start in _starts(pool, base, model):
        if near is not None and not _contends(start, near, pool.found[near]):
            continue  # what is larger is proposed from there, if it is needed
        # a fit goes on while it may come below the best; of instants, which move in small steps, its gain says little
        best = np.inf if start.hypothesis.limited else pool.found[leader(pool)].objective
        result = pool.try_set(
            step, start.hypothesis, start.values, start.states, TO_THE_END, give_up_above=best
        )  # fmt: skip
        tried += 1
        if is_at_noise(result):  # a fit that has not converged would not be white
            pool.go_on(step, start.hypothesis, TO_THE_END, 2)
            if pool.leaves_noise(start.hypothesis):
                near = start.hypothesis
    now = leader(pool)
    if not is_at_noise(pool.found[now]) and (now != lead or base == lead):
        # what a fit that stopped short leaves would be taken for more effects
        pool.go_on(step, now, TO_THE_END, 2)
    left = pool.found[now].data / at.count
    search.say(f"{step}: {tried} sets tried, best {_shown(now)}, {left:.4g} times the noise")
    pool.measure_noise(now)


def _contends(start: _Start, near: Hypothesis, at: Fit) -> bool:
    """Whether a proposal is no larger than a set that came near the noise, and predicted to come nearer, or near enough
    for what it has fewer."""
    more = start.hypothesis.size - near.size
    return more <= 0 and start.predicted + (1 + more) * required(at) < at.objective


def _shown(hypothesis: Hypothesis) -> str:
    return " + ".join(hypothesis.ids) or "the nominal equations"


def _starts(pool: Pool, base: Hypothesis, model: QuadraticModel) -> list[_Start]:
    """Where fits begin, the lowest first: a few of sets that only add to the base, and more of any others.

    To take out a large member is a long way, over which the quadratic model promises too much.
    """
    needed, found = required(model.at), dict[Hypothesis, _Start]()
    for keeping, most in ((True, ADDED), (False, FITTED)) if base.members else ((False, FITTED),):
        proposals = _worth_a_fit(pool, base, model, best_sets(model, MOST_TRIED, needed, keeping))
        others = [(hypothesis, proposal) for hypothesis, proposal in proposals if hypothesis not in found]
        found |= {start.hypothesis: start for start in _begun(pool, model, others)[:most]}
    return sorted(found.values(), key=lambda start: start.objective)


def _worth_a_fit(
    pool: Pool, base: Hypothesis, model: QuadraticModel, levels: Mapping[int, Sequence[Proposal]]
) -> list[tuple[Hypothesis, Proposal]]:
    """Of the best sets of each size: at the noise what is significant, else the best few of each size that explains
    noticeably more than a smaller one."""
    at = model.at
    needed, at_noise = required(at), is_at_noise(at)
    chosen: dict[Hypothesis, tuple[int, float, Proposal]] = {}
    least = np.inf
    for size, level in levels.items():
        if level[0].predicted + needed * size > least:
            continue
        least = level[0].predicted + needed * size
        more = needed * (size - base.size) - 0.5 * needed * (size <= base.size)
        of_size = 0
        for proposal in level:
            hypothesis = Hypothesis(tuple(sorted(option.member for option in proposal.options)))
            known = pool.found.get(hypothesis)
            tried = known is not None and known.objective < proposal.predicted + needed
            significant = not at_noise or proposal.predicted + more < at.objective
            if hypothesis == base or hypothesis in chosen or tried or not significant:
                continue
            chosen[hypothesis] = of_size, proposal.predicted + needed * size, proposal
            of_size += 1
            if of_size == OF_SIZE:
                break
    ranked = sorted(chosen.items(), key=lambda item: item[1][:2])
    return [
        (hypothesis, proposal) for hypothesis, (_, _, proposal) in ranked[: TRIED_AT_THE_NOISE if at_noise else TRIED]
    ]


@dataclass(frozen=True)
class _Start:
    """Where the fit of a proposal begins: at `objective`, of which the quadratic model predicts that `predicted` is
    left."""

    objective: float
    predicted: float
    hypothesis: Hypothesis
    values: dict[str, float]
    states: Array


def _begun(pool: Pool, model: QuadraticModel, proposals: Sequence[tuple[Hypothesis, Proposal]]) -> list[_Start]:
    """Where fits of proposals begin, the lowest first: of each the share of the predicted way that leads lowest."""
    starts = [model.start(proposal.options, share) for _, proposal in proposals for share in SHARES]
    objectives = objectives_at(pool.problem, starts)
    found = []
    for k, (hypothesis, proposal) in enumerate(proposals):
        shares = range(len(SHARES) * k, len(SHARES) * (k + 1))
        best = min(shares, key=lambda place: objectives[place])
        found.append(_Start(objectives[best], proposal.predicted, hypothesis, *starts[best]))
    return sorted(found, key=lambda start: start.objective)
