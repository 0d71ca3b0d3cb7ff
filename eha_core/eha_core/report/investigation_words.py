"""Sets and effects in words, for the terminal and the page of an investigation."""

from __future__ import annotations

from eha_core.diagnosis.result import Diagnosis, NamedEffect
from eha_core.effects import effect_title
from eha_core.investigation.ending import sets_of
from eha_core.report.finding import fitted_in_words, identified_parameters
from eha_core.report.wording import probable, words


def probability_of(found: Diagnosis, ids: tuple[str, ...]) -> float | None:
    """The probability of a set of effects; None of a rival outside the 95 % collection."""
    return next((each.probability for each in found.sets if set(each.effects) == set(ids)), None)


def set_title(ids: tuple[str, ...]) -> str:
    """A set of effects in words."""
    return " + ".join(map(effect_title, ids)) or "nothing is missing"


def effect_in_words(effect: NamedEffect) -> str:
    """An effect with its values and their 95 % intervals."""
    values = ", ".join(
        f"{words(name)} {fitted_in_words(value)}" for name, value in identified_parameters(effect).items()
    )
    return f"{effect_title(effect.id)} ({values})"


def possible_sets(found: Diagnosis) -> str:
    """The sets that are still possible, with their probabilities."""
    sets = [f"{set_title(ids)}{_chance(probability_of(found, ids))}" for ids in sets_of(found)]
    return sets[0] if len(sets) == 1 else f"{len(sets)} sets: {'; '.join(sets)}"


def _chance(probability: float | None) -> str:
    return "" if probability is None else f" ({probable(probability)})"
