"""What a diagnosis found, in words: the summary that the terminal, the report and diagnosis.json begin with."""

from __future__ import annotations

from collections.abc import Iterable

from eha_core.diagnosis.criteria import CERTAINTY, LEFT_IN_A_CHANNEL
from eha_core.diagnosis.result import CommonScale, Explained, NamedEffect, UnknownLaw
from eha_core.diagnosis.verdict import Decision
from eha_core.effects import effect_title
from eha_core.effects import effects as every_effect
from eha_core.quantities import quantity

_SCALES = {
    "clock": "the clock of the recording may run {times} times as fast as it should",
    "position": "the position may be read {times} times as large as it is",
    "pressures": "both pressures may be read {times} times as large as they are",
    "piston_area": "the nominal file may be another rig's: the piston's area may be {times} times the nominal one",
}


def summary(
    decision: Decision,
    effects: tuple[NamedEffect, ...],
    unknown: UnknownLaw | None,
    left: Explained,
    event: tuple[float, float] | None = None,
    scale: CommonScale | None = None,
) -> str:
    """The findings in words, after the interval of an event and a residual above the noise, where there are any."""
    said = _found_in_words(decision, effects, unknown)
    if scale is not None:
        times = quantity(scale.factor, "-", 3)
        said += f" {len(scale.parameters)} values are off by one factor: {_SCALES[scale.of].format(times=times)}."
    if event is not None:
        begin, end = (quantity(at, "s") for at in event)
        said = (
            f"The nominal model fails only from {begin} to {end}: an event on the rig, or a fault of the recording,"
            f" happened there. {said}"
        )
    if left.complete or not effects:
        return said
    if left.vague:
        return f"{said} The residual is noise, but this recording does not determine how strong the effects are."
    most = max(left.times_noise, key=lambda name: left.times_noise[name])
    many = "One effect" if len(effects) == 1 else f"{len(effects)} effects"
    many += " and a law explain" if unknown else " explains" if len(effects) == 1 else " explain"
    rest = (
        f"the residual is {left.times_noise[most]:.3g} times the noise, most in {most.replace('_', ' ')}"
        if left.times_noise[most] >= LEFT_IN_A_CHANNEL
        else "the residual is small, but not white noise"
    )
    return f"{many} {100.0 * left.share:.3g} % of the mismatch; {rest}, so more is missing. {said}"


def _found_in_words(decision: Decision, effects: tuple[NamedEffect, ...], unknown: UnknownLaw | None) -> str:
    if decision.as_given and decision.verdict != "consistent":
        return "Something is missing, but no model that was tried predicts held-out data better than the nominal one."
    if decision.verdict == "consistent":
        return "The nominal model explains the recording down to its noise; nothing is missing."
    if decision.verdict == "parameters":
        return "No physics is missing: parameter values differ from the nominal ones."
    if decision.verdict == "unknown_physics":
        return _summary_of_unknown(effects, unknown)
    named = _listed(effects)
    kind = common_kind(decision)
    if decision.verdict == "ambiguous" and kind:
        forms = " and ".join(
            _titles(ids) for ids in (decision.winner.ids, *(entry.ids for entry, _ in decision.rivals))
        )
        return (
            f"Physics is missing: {kind}; most simply, {named}. Its law cannot be identified from this recording:"
            f" {forms} explain it equally well."
        )
    if decision.verdict == "ambiguous":
        others = ", ".join(_titles(entry.ids) for entry, _ in decision.rivals)
        return f"Physics is missing, most likely: {named}. In this recording it cannot be distinguished from {others}."
    return f"Physics is missing: {named}."


def _titles(ids: Iterable[str]) -> str:
    return " + ".join(map(effect_title, ids))


def _listed(effects: tuple[NamedEffect, ...]) -> str:
    """The effects' statements, each with its probability where that is below CERTAINTY."""
    return "; and ".join(f"{effect.statement}{_doubt(effect)}" for effect in effects)


def _doubt(effect: NamedEffect) -> str:
    return f" (probability {100.0 * effect.probability:.0f} %)" if effect.probability < CERTAINTY else ""


def common_kind(decision: Decision) -> str:
    """The kind of law, if the winner and all its rivals differ only in the form of one law; else empty."""
    kinds = set()
    for entry, _ in decision.rivals:
        own, other = (set(explanation.hypothesis.members) for explanation in (decision.winner, entry))
        differing = [*(own - other), *(other - own)]
        if len(differing) != 2 or differing[0].effect.kind != differing[1].effect.kind:
            return ""
        kinds.add(differing[0].effect.kind)
    return kinds.pop() if len(kinds) == 1 else ""


def _summary_of_unknown(effects: tuple[NamedEffect, ...], law: UnknownLaw | None) -> str:
    if law is None:
        return "Physics is missing that is not in the catalogue, and no law over the measured states explains it."
    statement = next(effect.statement for effect in every_effect() if effect.site == law.site and not effect.named)
    unknown = f"{statement}, as a function of {law.function_of}"
    if not effects:
        return f"Something is missing: {unknown}."
    named = _listed(effects)
    return f"Physics is missing: {named}; and a law that is not in the catalogue: {unknown}."
