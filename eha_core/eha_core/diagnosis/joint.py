"""Several recordings of one rig: what one cannot tell apart, another may."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.evidence import Evidence
from eha_core.diagnosis.fit import Fit, fit
from eha_core.diagnosis.hypotheses import Start
from eha_core.diagnosis.hypothesis import LIMITED, Hypothesis
from eha_core.diagnosis.problem import Problem
from eha_core.diagnosis.refine import attempt_on, try_effect
from eha_core.diagnosis.screen import Promise
from eha_core.diagnosis.tournament import ENOUGH, Entry, Tournament, rank, scatter
from eha_core.diagnosis.verdict import decide


def join(evidences: Sequence[Evidence]) -> Evidence:
    """The evidence of the recording that tells most, with every gain the sum over all recordings.

    Each recording keeps its own nominal parameters; a hypothesis that one of them did not refit is refitted there. It
    is one law of one rig, and pays for its parameters once.
    """
    if len(evidences) == 1:
        return evidences[0]
    wanted: dict[Hypothesis, Entry] = {}
    for evidence in evidences:
        for entry in evidence.tournament.entries:
            if entry.score > ENOUGH and entry.score > evidence.tournament.entries[0].score - 10.0 * ENOUGH:
                wanted.setdefault(entry.hypothesis, entry)
    completed = [_completed(evidence, wanted) for evidence in evidences]
    lead = int(np.argmax([max([0.0, *(entry.score for entry in one.entries)]) for one in completed]))
    totals = {hypothesis: joint_score(completed, hypothesis) for hypothesis in wanted}
    entries = sorted(
        (
            replace(entry, score=totals[entry.hypothesis])
            for entry in completed[lead].entries
            if entry.hypothesis in totals
        ),
        key=lambda entry: -entry.score,
    )
    chosen = evidences[lead]
    tournament = replace(completed[lead], entries=tuple(entries))
    recovery = chosen.recovery
    if recovery is not None and len(entries):
        # a curve's score is of one recording; hold the sum against as much of it
        share = entries[0].score / max(joint_score(completed[lead : lead + 1], entries[0].hypothesis), 1.0)
        recovery = replace(recovery, score=recovery.score * share)
    decision = decide(chosen.calibration, chosen.nominal, tournament, recovery)
    return replace(chosen, tournament=tournament, decision=decision)


def joint_score(tournaments: Sequence[Tournament], hypothesis: Hypothesis) -> float:
    """A hypothesis' gain over all recordings less the dearest of the costs of its parameters."""
    entries = [entry for one in tournaments for entry in one.entries if entry.hypothesis == hypothesis]
    return sum(entry.score + entry.cost for entry in entries) - max(entry.cost for entry in entries)


def _completed(evidence: Evidence, wanted: Mapping[Hypothesis, Entry]) -> Tournament:
    """The tournament with every wanted hypothesis in it."""
    tournament, problem = evidence.tournament, evidence.calibration.problem
    found = {entry.hypothesis: entry.fit for entry in tournament.entries}
    for hypothesis, entry in wanted.items():
        if hypothesis in found:
            continue
        if hypothesis.limited:
            found[hypothesis] = _within_its_interval(problem, tournament.nominal.fit, entry)
            continue
        base = tournament.nominal.fit
        for effect in entry.effects:
            values = {name: entry.fit.values[name] for name in effect.parameter_names()}
            promise = next((one for one in tournament.promises if one.start.effect.id == effect.id), None)
            factor = promise.factor if promise is not None else 1.0
            start = Promise(Start(effect, values), 0.0, 1.0 if factor > 0.0 else factor)
            base = try_effect(problem, attempt_on(base, start), np.inf)
        found[hypothesis] = base
    entries = rank(problem, tournament.nominal.fit, found)
    return replace(tournament, entries=entries, scatter=scatter(tournament.nominal.fit, entries))


def _within_its_interval(problem: Problem, nominal: Fit, entry: Entry) -> Fit:
    """A time-limited hypothesis of another recording fitted to this one, in the interval that it had there."""
    own = {*LIMITED, *(name for effect in entry.effects for name in effect.parameter_names())}
    values = {**nominal.values, **{name: entry.fit.values[name] for name in own}}
    free = (*nominal.free, *(one for one in entry.fit.free if one.name in own))
    return fit(problem, values, free, nominal.states, iterations=25)
