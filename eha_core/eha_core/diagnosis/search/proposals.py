"""Proposals: which effects to add to a set, and from where to fit them.

A score test says how much of what a fit leaves unexplained an effect could explain (`screening`). It is linear,
so it is asked where the effects show best: at the fit itself; where that is far from the noise, at the nominal values,
which nothing has biased; and with the valve's dynamics held, which can imitate a delay or a lag.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from statistics import fmean

from eha_core.diagnosis.criteria import FAR_FROM_NOISE, NEAR_NOISE
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import Member
from eha_core.diagnosis.search.candidates import Candidate, Proposal, Search, without_effect
from eha_core.diagnosis.search.initial_guesses import InitialGuess, initial_guesses
from eha_core.diagnosis.search.nominal_start import (
    HELD_SHARE,
    TRIED_WITH_DYNAMICS_HELD,
    at_nominal_values,
    set_free,
    with_dynamics_held,
)
from eha_core.diagnosis.search.screening import ScoreTest, one_each, scaled, screen
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import LATE
from eha_core.identification.per_recording import is_one_of

AT_THE_FIT = 8
AT_NOMINAL_VALUES = 6
"""How many effects are taken from each score test."""

LEAST_PREDICTED = 0.02
"""Where the fit is not far from the noise, so that predictions hold, an effect that predicts less than this share of
what the first predicts is left for a later round: it is asked again once the first has been added (assumed)."""


def proposals(search: Search, base: Candidate, score_tests: Sequence[ScoreTest], least: float) -> list[Proposal]:
    """The base's set with one effect more, the largest predicted gain first, of those above `least`.

    score_tests: those of the initial guesses beside the base, at its fit.
    """
    begin = guesses_beside(search, base)
    added = [
        *_at_the_fit(base, score_tests),
        *_at_nominal_values(search, base, begin),
        *_with_dynamics_held(search, base, begin),
    ]
    # where only noise is left no other form can be better
    forms = in_another_form(search, base) if base.times_noise > NEAR_NOISE else ()
    new_forms = [proposal for proposal in forms if proposal.hypothesis not in search.found]
    return [*new_forms, *(proposal for proposal in added if proposal.predicted > least)]


def at_the_fit(search: Search, base: Candidate, most: int) -> list[Proposal]:
    """The base's set with one effect more, as a score test at its fit ranks them."""
    score_tests = one_each(screen(search.problem, base.fit, guesses_beside(search, base)), most)
    return [_proposal(base, base.fit, score_test) for score_test in score_tests]


def _leading(score_tests: Sequence[ScoreTest], base: Candidate) -> Sequence[ScoreTest]:
    """Those whose predicted gain is worth a refit beside the first's."""
    if base.times_noise > FAR_FROM_NOISE:
        return score_tests
    return [score_test for score_test in score_tests if score_test.gain > LEAST_PREDICTED * score_tests[0].gain]


def guesses_beside(search: Search, base: Candidate) -> list[InitialGuess]:
    """The initial guesses of every effect that the base's set admits."""
    applicable = [effect for effect in search.applicable if base.hypothesis.admits(effect)]
    return [guess for effect in applicable for guess in initial_guesses(effect, search.scales)]


def _at_the_fit(base: Candidate, score_tests: Sequence[ScoreTest]) -> Iterator[Proposal]:
    always = [score_test for score_test in score_tests if score_test.windows is None]
    for score_test in _leading(one_each(always, AT_THE_FIT), base):
        yield _proposal(base, base.fit, score_test)


def _at_nominal_values(search: Search, base: Candidate, begin: list[InitialGuess]) -> Iterator[Proposal]:
    if base.fit.data <= FAR_FROM_NOISE * base.fit.count:
        return
    nominal = at_nominal_values(search.problem, base.fit)
    for score_test in one_each(screen(search.problem, nominal, begin), AT_NOMINAL_VALUES):
        yield _proposal(base, nominal, score_test, in_stages=True)


def _with_dynamics_held(search: Search, base: Candidate, begin: list[InitialGuess]) -> Iterator[Proposal]:
    held = with_dynamics_held(search.problem, base.fit)
    if held is None:
        return
    # what the dynamics could imitate shows only while they are held
    at = set_free(held, tuple(parameter for parameter in base.fit.free if not is_one_of(parameter.name, LATE)))
    for score_test in one_each(screen(search.problem, at, begin), TRIED_WITH_DYNAMICS_HELD):
        proposal = _proposal(base, held, score_test, in_stages=True)
        yield replace(proposal, predicted=proposal.predicted / HELD_SHARE)


def _proposal(base: Candidate, at: Fit, score_test: ScoreTest, in_stages: bool = False) -> Proposal:
    effect = score_test.guess.effect
    values: Mapping[str, float] = {**at.values, **scaled(score_test)}
    free = with_effects(base.fit.free, [effect], values)
    return Proposal(base.hypothesis.with_effects([effect]), values, free, at.states, score_test.gain, in_stages)


def in_another_form(search: Search, base: Candidate) -> Iterator[Proposal]:
    """The set with another form of a member's law, from its own values where they share a parameter.

    A law that acts over an interval got its form when its interval was found.
    """
    for member in (member for member in base.hypothesis.members if not member.limited):
        rest = base.hypothesis.without(member)
        values, free = without_effect(base.fit, member.effect)
        forms = [effect for effect in search.applicable if member.effect.kind and effect.kind == member.effect.kind]
        for effect in (form for form in forms if form.id != member.id):
            for guess in initial_guesses(effect, search.scales):
                begun = {**values, **_as_large(guess, member, base.fit)}
                yield Proposal(rest.with_effects([effect]), begun, with_effects(free, [effect], begun), base.fit.states)


def _as_large(guess: InitialGuess, member: Member, result: Fit) -> dict[str, float]:
    """A guess of one form of a law with another form's values where both have the parameter, and its other sizes in
    proportion to the first size that both have.

    That is the mean of the other form's where it has more sizes: Coulomb's force for Stribeck's at rest and in motion.
    """
    sizes = [row.name for row in guess.effect.parameters if row.switches]
    theirs = {row.name: result.values[f"{member.id}.{row.name}"] for row in member.effect.parameters}
    of_theirs = [row.name for row in member.effect.parameters if row.switches]
    common = next((name for name in sizes if name in of_theirs), None)
    if common is None:
        return dict(guess.values)
    if not set(of_theirs) <= set(sizes):
        theirs[common] = fmean(theirs[name] for name in of_theirs)
    share = theirs[common] / guess.values[f"{guess.effect.id}.{common}"]
    found = {}
    for name, value in guess.values.items():
        own = name.rsplit(".", 1)[1]
        found[name] = theirs.get(own, share * value if own in sizes else value)
    return found
