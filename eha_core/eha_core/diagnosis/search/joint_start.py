"""Joint start: the whole catalogue fitted at once from the nominal values, to see what remains standing.

Adding effects one by one takes the best imitation first, and what is taken first biases all that follows. So, once,
every effect is switched on a little and all are fitted together; those that it would cost most to drop make the set
from which the search goes on.
"""

from __future__ import annotations

from eha_core.diagnosis.hypotheses import starts
from eha_core.diagnosis.hypothesis import NOTHING, neutral
from eha_core.diagnosis.refine import as_given
from eha_core.diagnosis.screen import ScoreTest, one_each, screen, sized
from eha_core.diagnosis.search.candidates import Candidate, Guess, Search, with_effects
from eha_core.diagnosis.search.prune import wald
from eha_core.effects import Effect
from eha_core.identification.fit import fit
from eha_core.identification.freedom import LATE, Free
from eha_core.identification.per_recording import is_one_of

SHARES = (0.1, 0.3)
"""Of an effect's usual first guess, at which it is switched on."""

KEPT = 5
"""How many effects the search goes on with."""


def joint_start(search: Search, nominal: Candidate) -> Candidate:
    """The set that stands out when everything is fitted at once."""
    at = as_given(search.problem, nominal.fit)
    able = _one_form_each([effect for effect in search.able if _is_smooth(effect)])
    begin = [start for effect in able for start in starts(effect, search.facts)]
    score_tests = one_each(screen(search.problem, at, begin), len(able))
    effects = [score_test.start.effect for score_test in score_tests]
    best = nominal
    for share in SHARES:
        search.progress(f"fitting the whole catalogue at once from {share:g} of its usual sizes")
        values = {**at.values}
        for score_test in score_tests:
            values |= sized(score_test.start, share if score_test.factor >= 0.0 else -share)
        free = with_effects(at.free, effects, values)
        switches = _sizes(score_tests, values)
        free = tuple(switches.get(one.name, one) for one in free)
        soon = [one for one in free if not is_one_of(one.name, LATE)]
        early = fit(search.problem, values, soon, at.states, iterations=12)
        whole = fit(search.problem, early.values, free, early.states, iterations=8)
        top = sorted(effects, key=lambda effect: -wald(whole, effect))[:KEPT]
        reduced = {**whole.values}
        for effect in effects:
            if effect not in top:
                reduced |= neutral(effect)
        kept = with_effects(nominal.fit.free, top, reduced)
        guess = Guess(NOTHING.with_effects(top), reduced, kept, whole.states)
        best = min(best, search.try_guess(guess, 12), key=lambda one: one.fit.objective)
    search.report(best)
    return best


def _is_smooth(effect: Effect) -> bool:
    """Whether its outcome moves smoothly with its parameters: an instant or a place has to be met."""
    return all(row.relative_to not in ("time", "position") for row in effect.parameters)


def _one_form_each(effects: list[Effect]) -> list[Effect]:
    """Of the forms of one law the one with the fewest parameters."""
    chosen: dict[str, Effect] = {}
    for effect in effects:
        known = chosen.get(effect.kind or effect.id)
        if known is None or len(effect.parameters) < len(known.parameters):
            chosen[effect.kind or effect.id] = effect
    return list(chosen.values())


def _sizes(score_tests: tuple[ScoreTest, ...], values: dict[str, float]) -> dict[str, Free]:
    """The sizes, free in units of the start's: so one can vanish and come back."""
    found = {}
    for score_test in score_tests:
        effect = score_test.start.effect
        for name, row in zip(effect.parameter_names(), effect.parameters, strict=True):
            if row.switches:
                scale = abs(score_test.start.values[name] - row.nominal) or 1.0
                found[name] = Free(name, values[name], False, scale, 30.0, row.lower, row.upper)
    return found
