"""Short windows first: laws of friction that stick are led to their optimum, which long windows hide.

Where everything is far from the noise, or friction explains most and not all, each form of dry friction is fitted by
itself from short windows to long ones, and so is a set that has one; what they find is compared with all else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.criteria import UNFITTED
from eha_core.diagnosis.effect_parameters import with_effects
from eha_core.diagnosis.hypothesis import NOTHING, Hypothesis
from eha_core.diagnosis.search.candidates import Candidate, Search, without_effect
from eha_core.diagnosis.search.initial_guesses import initial_guesses
from eha_core.diagnosis.search.nominal_start import is_improbable
from eha_core.effects import Effect
from eha_core.identification.fit import Fit
from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.parallel import each
from eha_core.identification.per_recording import base_name
from eha_core.identification.short_windows import (
    from_short_windows,
    is_of_an_effect,
    over_the_shortest,
    to_long_windows,
)

STICKING = "dry friction"
"""The kind of law that can hold the piston at rest."""

LED = 2
"""Of the forms of dry friction, how many are led on to long windows: those that leave least over the shortest. Assumed;
the right one and its nearest rival have to be distinguished there."""


def forms_of_friction(search: Search, nominal: Candidate) -> Candidate:
    """The best so far when the forms of dry friction were led from short windows to long ones."""
    return _each_form(search, NOTHING, nominal.fit, nominal.fit.values, nominal.fit.free)


def set_in_each_form(search: Search, best: Candidate) -> Candidate:
    """The best so far when the forms of the set's dry friction were led from short windows to long ones beside the
    other members."""
    member = next(member for member in best.hypothesis.members if member.effect.kind == STICKING)
    return _each_form(search, best.hypothesis.without(member), best.fit, *without_effect(best.fit, member.effect))


def _each_form(
    search: Search, rest: Hypothesis, at: Fit, values: Mapping[str, float], free: tuple[FreeParameter, ...]
) -> Candidate:
    def announce(effect: Effect) -> None:
        search.progress(f"fitting {' + '.join(rest.with_effects([effect]).ids)} over short windows")

    effects = _that_stick(search.applicable)
    for begun in _begins(at, values, free):
        forms = list(zip(effects, each(partial(_over_short, search, begun, free), effects, announce), strict=True))
        leading = sorted(forms, key=lambda form: form[1].objective)[:LED]
        for (effect, _), found in zip(leading, each(partial(_over_long, search, free), leading), strict=True):
            search.keep(rest.with_effects([effect]), found)
        reached = search.best
        if reached.times_noise < UNFITTED:
            break
    return reached


def _over_short(search: Search, values: Mapping[str, float], free: tuple[FreeParameter, ...], effect: Effect) -> Fit:
    own = first_guess(effect, search.scales)
    return over_the_shortest(search.shorter, {**values, **own}, with_effects(free, [effect], own))


def _over_long(search: Search, free: tuple[FreeParameter, ...], form: tuple[Effect, Fit]) -> Fit:
    effect, led = form
    its = with_effects(free, [effect], led.values)
    return to_long_windows(search.problem, search.shorter, led.values, its)


def _begins(at: Fit, values: Mapping[str, float], free: Sequence[FreeParameter]) -> list[Mapping[str, float]]:
    """From where sets are led: the nominal values, which nothing has biased; then those of a fit, where it lies
    improbably far from them."""
    nominal = at_nominal(values, tuple(parameter for parameter in free if not is_of_an_effect(parameter)))
    return [nominal, values] if is_improbable(at) else [nominal]


def set_with_friction(search: Search, best: Candidate) -> Candidate:
    """A set with a law that sticks, led from short windows to long ones; the set as it is where it has none.

    That law begins at its first guess. In long windows its shape may have been lost (a Stribeck velocity of next to
    nothing), from where no derivative leads back. The others begin where they are.
    """
    if not sticks(best.hypothesis):
        return best
    effect, *_ = _that_stick(best.hypothesis.effects)
    search.progress(f"fitting {' + '.join(best.hypothesis.ids)} from short windows to long ones")
    led = best
    for begun in _begins(best.fit, best.fit.values, best.fit.free):
        values = {**begun, **first_guess(effect, search.scales)}
        found = from_short_windows(search.problem, search.shorter, values, best.fit.free)
        led = search.keep(best.hypothesis, found)
        if led.times_noise < UNFITTED:
            break
    return led


def first_guess(effect: Effect, scales: Scales) -> dict[str, float]:
    """The last initial guess of those that turn on most of the effect's sizes, but a Stribeck velocity as large as the
    speeds: a fit finds its way from one that is too large, and from one that is too small no derivative leads back."""
    rows = dict(zip(effect.parameter_names(), effect.parameters, strict=True))
    values = dict(
        max(
            reversed(initial_guesses(effect, scales)),
            key=lambda guess: sum(row.switches and guess.values[name] != row.nominal for name, row in rows.items()),
        ).values
    )
    for name, row in rows.items():
        if row.relative_to == "speed":
            origin, scale = scales.by_quantity["speed"]
            values[name] = min(max(origin + scale, row.lower), row.upper)
    return values


def sticks(hypothesis: Hypothesis) -> bool:
    """Whether one of the effects can hold the piston at rest, and always acts: short windows would lose when one that
    does not begins and ceases to."""
    return bool(_that_stick([member.effect for member in hypothesis.members if not member.limited]))


def _that_stick(effects: Sequence[Effect]) -> list[Effect]:
    return [effect for effect in effects if effect.kind == STICKING]


def at_nominal(values: Mapping[str, float], free: tuple[FreeParameter, ...]) -> dict[str, float]:
    """Values with those that are free at their nominal ones."""
    return {
        **values,
        **{parameter.name: parameter.reference for parameter in free if base_name(parameter.name) in values},
    }
