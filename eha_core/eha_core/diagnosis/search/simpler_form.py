"""Simpler form: what grows where a law's form has fewer parameters than the best set's.

The shape of a rich form takes what a weak member beside a plainer one would explain: Stribeck's curve bends as dry
friction with quadratic damping does. So where a plainer form comes near, the search goes on from there, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from eha_core.diagnosis.criteria import parameter_cost
from eha_core.diagnosis.effect_freedom import freedom_used
from eha_core.diagnosis.search.candidates import Candidate, Guess, Search
from eha_core.diagnosis.search.grow import grow
from eha_core.diagnosis.search.proposals import in_another_form

CLOSE = 100.0
"""Chi^2 by which a set may lie behind the best and still be fitted to its end, or go on."""

ITERATIONS = 20
"""Of a fit in another form, which gives up where it cannot come close."""


def from_a_simpler_form(search: Search, best: Candidate) -> Candidate:
    """The best set, or what grows from it in a form with fewer parameters where that explains as much for its cost."""
    simpler = [guess for guess in in_another_form(search, best) if len(guess.free) < len(best.fit.free)]
    close = [one for one in try_forms(search, best, simpler) if one.fit.objective < best.fit.objective + CLOSE]
    if not close:
        return best
    grown = grow(search, min(close, key=lambda one: one.fit.objective))
    return for_its_cost(search, [search.again(best), grown])


def try_forms(search: Search, best: Candidate, guesses: Iterable[Guess]) -> list[Candidate]:
    """The guesses fitted, each given up where it cannot come close to the best set."""
    found = []
    for guess in guesses:
        search.progress(f"trying {' + '.join(guess.hypothesis.ids)}")
        found.append(search.try_guess(guess, ITERATIONS, give_up_above=best.fit.objective + CLOSE))
    return found


def for_its_cost(search: Search, candidates: Sequence[Candidate]) -> Candidate:
    """The one of least chi^2 when every parameter that it makes use of has been paid for."""
    least = min(max(1.0, one.times_noise) for one in candidates)
    dear = parameter_cost(search.problem.count(), least)
    return min(candidates, key=lambda one: one.fit.objective + dear * freedom_used(one.fit))
