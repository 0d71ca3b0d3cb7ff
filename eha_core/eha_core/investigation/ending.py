"""When and why an investigation ends, from the diagnoses of all tests so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eha_core.diagnosis.criteria import CHANCE
from eha_core.diagnosis.result import Diagnosis

ENDINGS = {
    "resolved": "one set remains",
    "nothing_more": "no further test would tell more",
    "limit_of_tests": "the limit of tests is reached",
    "limit_of_time": "the limit of time is reached",
    "stopped": "the motion was stopped",
    "failed": "what was recorded cannot be used",
}
"""How an investigation can end."""


@dataclass(frozen=True)
class Ending:
    """Which of ENDINGS it is, and why in a sentence."""

    kind: str
    statement: str


def sets_of(diagnosis: Diagnosis) -> tuple[tuple[str, ...], ...]:
    """The sets of effects that are still possible, the most probable first; () where nothing is missing."""
    named = tuple(effect.id for effect in diagnosis.effects)
    rivals = (alternative.effects for alternative in diagnosis.alternatives)
    probable = (each.effects for each in diagnosis.sets)
    return tuple(dict.fromkeys(tuple(sorted(each)) for each in (named, *probable, *rivals)))


def settled(diagnoses: Sequence[Diagnosis]) -> Ending | None:
    """Why no further test is needed after the last of these diagnoses; None where one is."""
    last = diagnoses[-1]
    if last.verdict == "unknown_physics":
        return Ending("nothing_more", f"no set of effects of the catalogue explains the tests. {last.summary}")
    if len(sets_of(last)) == 1:
        return Ending("resolved", last.summary)
    test = last.next_experiment
    if test is None:
        return Ending("nothing_more", f"{last.summary} No test is proposed that distinguishes the remaining sets.")
    if not test.reference:
        return Ending("nothing_more", test.statement)
    if test.record:
        channels = " and ".join(test.record)
        return Ending("nothing_more", f"{channels} would have to be recorded too. {test.statement}")
    if test.expected < CHANCE:
        return Ending("nothing_more", test.statement)
    if any(_same(last, earlier) for earlier in diagnoses[:-1]):
        return Ending("nothing_more", f"the proposed test was made already and left the same rivals: {test.statement}")
    return None


def _same(one: Diagnosis, other: Diagnosis) -> bool:
    """Whether two diagnoses have the same possible sets and propose the same test."""
    tests = [each.next_experiment.reference if each.next_experiment else None for each in (one, other)]
    return tests[0] == tests[1] and set(sets_of(one)) == set(sets_of(other))
