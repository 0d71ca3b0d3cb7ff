"""Which terms a law has: forward, with exchange within a kind, and backward, judged on blocks that no fit has seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from eha_core.motion_given.law import (
    Law,
    Regression,
    finish,
    held_out_errors,
    ordered,
    search_shape,
    solve_for,
)
from eha_core.motion_given.motion import Array, Motion
from eha_core.motion_given.schedule import MOST_LEVELS, scheduled_terms
from eha_core.motion_given.terms import TERMS, Term

WORTH = 0.15
"""Share of the held-out squared error that a term must take away to be added, and that leaving it out must bring back.
Assumed, with the recordings of docs/real.md in view: at 0.1 a mass is added to the damper, where nothing is heavy."""

PLAIN = 0.0002
"""The same as a share of the force's whole variance: 1.4 % of its amplitude. A smaller term is a detail of another's
form (assumed)."""

CERTAIN = 2.0
"""Standard errors over the held-out blocks by which a term must lower their error."""

COLLINEAR = 1e-4
"""Share of a column beyond what the others explain, below which it cannot be distinguished from them."""

AT_WORK = 1e-6
"""Share of the largest size, in units of its column, from which on a bounded fit has not set a size to zero."""

CONTAINED = ("viscous_friction",)
"""Terms that others of their kind contain."""

NOISE_REACHED = 1.2
"""RMS of the residual over the force's noise below which nothing is added; noise is known to a few per cent."""


@dataclass(frozen=True)
class Try:
    """A set with its shapes and the squared error of each held-out block [N^2]."""

    law: Law
    errors: Array

    @property
    def mean(self) -> float:
        """The mean squared error of the held-out blocks [N^2]."""
        return float(np.mean(self.errors))


def find_law(motions: Sequence[Motion], progress: Callable[[str], None] = lambda _: None) -> Law:
    """The law of fewest terms that explains the force of recordings of one rig, on blocks that its fit has not seen."""
    regression = Regression.of(motions)
    total = float(np.var(regression.force[regression.held_out]))
    able = tuple(term for term in TERMS if _can_show(term, motions))
    able = (*able, *(term for most in (2, MOST_LEVELS) for term in scheduled_terms(motions, most)))
    nothing = _try(regression, (), None)
    together = _pruned(regression, _try(regression, _linear(regression, able), None), able, total)
    found = [_grown(regression, start, able, total, progress) for start in (nothing, together)]
    best = _simplest([tried for tried in found if np.isfinite(tried.mean)])
    return finish(regression, best.law.terms, best.law)


def _linear(regression: Regression, able: Sequence[Term]) -> tuple[Term, ...]:
    """The linear terms that are at work where all are fitted at once, with no friction, spring or mass below zero."""
    terms = [term for term in able if not term.shapes and not term.levels and term.id not in CONTAINED]
    columns = regression.columns(terms, ())
    sizes = solve_for(terms, columns, regression.force) * np.sqrt(np.sum(columns**2, axis=0))
    owners = [term.id for term in terms for _ in term.sizes]
    at_work = {owner for owner, size in zip(owners, sizes, strict=True) if abs(size) > AT_WORK * np.max(np.abs(sizes))}
    return ordered([term for term in terms if term.id in at_work])


def _grown(
    regression: Regression, best: Try, able: Sequence[Term], total: float, progress: Callable[[str], None]
) -> Try:
    """What adding to a set leads to, where every addition has to earn its place and keep the others'."""
    while np.sqrt(best.mean) > NOISE_REACHED * (regression.noise or 0.0):
        progress(f"{' + '.join(best.law.ids) or 'nothing'} leaves {100 * np.sqrt(best.mean / total):.1f} %")
        larger = [terms for terms in _neighbours(best.law.terms, able) if not _collinear(regression, terms, best.law)]
        grown = [_try(regression, terms, best.law) for terms in larger]
        earning = [tried for tried in grown if _earns(best, tried, total)]
        if not earning:
            break
        best = _pruned(regression, _simplest(earning), able, total)
    return best


def worth_of(motions: Sequence[Motion], law: Law) -> dict[str, float]:
    """What each term of a law is worth: the log-likelihood ratio that leaving it out costs on the held-out blocks."""
    regression = Regression.of(motions)
    whole = held_out_errors(regression, law.terms, law.shape)
    found = {}
    for term in law.terms:
        fewer = _try(regression, [other for other in law.terms if other is not term], law)
        # a block counts once, however many samples it has: its residual is correlated
        found[term.id] = float(len(whole) * np.log(fewer.mean / np.mean(whole)))
    return found


def _simplest(tries: Sequence[Try]) -> Try:
    """The one of fewest parameters among those that are as good as the best, but for what a term must be worth."""
    least = min(tried.mean for tried in tries)
    near = [tried for tried in tries if tried.mean * (1.0 - WORTH) <= least]
    return min(
        near, key=lambda tried: (sum(len(term.sizes) + len(term.shapes) for term in tried.law.terms), tried.mean)
    )


def _can_show(term: Term, motions: Sequence[Motion]) -> bool:
    return not term.needs_pressure or all(motion.pressure is not None for motion in motions)


def _neighbours(terms: Sequence[Term], able: Sequence[Term]) -> list[tuple[Term, ...]]:
    """Sets with one term more, in place of the one of its kind."""
    others = [term for term in able if term not in terms]
    return [ordered([*(old for old in terms if old.kind != term.kind), term]) for term in others]


def _try(regression: Regression, terms: Sequence[Term], known: Law | None) -> Try:
    shape = search_shape(regression, terms, ~regression.held_out, known)
    errors = held_out_errors(regression, terms, shape)
    return Try(Law(tuple(terms), tuple(shape), (), 0.0, 0.0), errors)


def _collinear(regression: Regression, terms: Sequence[Term], known: Law) -> bool:
    """Whether a linear term that is new cannot be distinguished from the set's other columns."""
    if any(term.shapes for term in terms if term not in known.terms) or len(terms) < 2:
        return False
    shape = _carried(terms, known)
    if shape is None:
        return False
    columns = regression.columns(terms, shape)
    columns = columns / (np.sqrt(np.sum(columns**2, axis=0)) + 1e-300)
    return bool(np.linalg.svd(columns, compute_uv=False)[-1] ** 2 < COLLINEAR)


def _carried(terms: Sequence[Term], known: Law) -> list[float] | None:
    """The shapes of a set whose shaped terms a law already has."""
    found: dict[str, list[float]] = {}
    place = 0
    for term in known.terms:
        found[term.id] = list(known.shape[place : place + len(term.shapes)])
        place += len(term.shapes)
    if any(term.shapes and term.id not in found for term in terms):
        return None
    return [value for term in terms for value in found.get(term.id, ())]


def _earns(without: Try, with_it: Try, total: float) -> bool:
    """Whether the second set is better than the first by more than chance and by enough to matter."""
    if not np.isfinite(with_it.mean) or not np.isfinite(without.mean):
        return bool(np.isfinite(with_it.mean))
    gain = without.errors - with_it.errors
    certain = float(np.mean(gain)) > CERTAIN * float(np.std(gain, ddof=1)) / np.sqrt(len(gain))
    return bool(certain and float(np.mean(gain)) > max(WORTH * without.mean, PLAIN * total))


def _plainer(terms: Sequence[Term], able: Sequence[Term]) -> list[Term]:
    """Forms with fewer parameters, of the kinds that a set has."""

    def parameters(term: Term) -> int:
        return len(term.sizes) + len(term.shapes)

    return [
        plain for plain in able for term in terms if plain.kind == term.kind and parameters(plain) < parameters(term)
    ]


def _pruned(regression: Regression, best: Try, able: Sequence[Term], total: float) -> Try:
    """The set without the terms that do not earn their place beside the others."""
    while len(best.law.terms) > 1:
        fewer = [ordered([other for other in best.law.terms if other is not term]) for term in best.law.terms]
        fewer += [ordered([term for term in best.law.terms if term.kind != plain.kind] + [plain]) for plain in
                  _plainer(best.law.terms, able)]  # fmt: skip
        tries = [_try(regression, terms, best.law) for terms in fewer]
        weakest = min(tries, key=lambda tried: tried.mean)
        if _earns(weakest, best, total):
            return best
        best = weakest
    return best
