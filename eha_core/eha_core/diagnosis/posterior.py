"""The probability of each set of effects, and so of each name: tempered scores of the sets that were compared.

A name can be wrong in three ways: another set explains the recording as well (its score is close), the effect gains
little more than chance and the form of the other laws could (its gain is close to the required one), or the search did
not find the true set (it had to begin anew). Each is turned into odds with a scale that was set on development cases;
the prior is otherwise flat.
"""

from __future__ import annotations

from math import exp, log

from eha_core.diagnosis.criteria import CERTAINTY, MISSED, ODDS_OF_GAIN, TIE, TRUE_EVEN_SO
from eha_core.diagnosis.result import ProbableSet
from eha_core.diagnosis.search.comparison import Entry, ModelComparison, bounded

TEMPERATURE = TIE / (2.0 * log(CERTAINTY / (1.0 - CERTAINTY)))
"""Temperature of the scores' Boltzmann factors: of two sets whose scores differ by TIE, the better has CERTAINTY."""


def probable_sets(comparison: ModelComparison, winner: Entry) -> tuple[ProbableSet, ...]:
    """The fewest sets that together have CERTAINTY of what the compared sets have, the most probable first; the rest to
    one is that of sets that were not found.

    Candidates are the compared sets that do not merely add to the winner, and the winner without each of its members.
    """
    if not winner.effects:
        return ()
    weights: dict[tuple[str, ...], float] = {}
    for entry in comparison.entries:
        adds = set(winner.ids) < set(entry.ids)
        if entry.effects and not adds and not bounded(entry):
            weight = exp(min((entry.score - winner.score) / (2.0 * TEMPERATURE), 0.0))
            weights[entry.ids] = max(weight, weights.get(entry.ids, 0.0))
    weights[winner.ids] = 1.0
    for member, ratio in comparison.gain_over_required.items():
        without = winner.hypothesis.without(member).ids
        weights[without] = max(weights.get(without, 0.0), max(ratio, 1e-300) ** -ODDS_OF_GAIN)
    total, seen = sum(weights.values()), 1.0 - missed(comparison)
    ranked = sorted(weights.items(), key=lambda item: -item[1])
    found, held = [], 0.0
    for ids, weight in ranked:
        found.append(ProbableSet(ids, seen * weight / total))
        held += weight / total
        if held >= CERTAINTY:
            break
    return tuple(found)


def missed(comparison: ModelComparison) -> float:
    """The probability that the true set is none of those that were compared."""
    return MISSED if comparison.begun_anew else 0.0


def probability(sets: tuple[ProbableSet, ...], effect: str, missed: float = 0.0) -> float:
    """The probability of a name: the share of the collection's probability in sets that contain it, and some of what is
    `missed`."""
    total = sum(each.probability for each in sets)
    share = sum(each.probability for each in sets if effect in each.effects) / total if total else 0.0
    return (1.0 - missed) * share + missed * TRUE_EVEN_SO
