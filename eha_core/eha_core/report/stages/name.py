"""Stage 4, name: the hypotheses compared."""

from __future__ import annotations

from eha_core.diagnosis.criteria import CERTAINTY, ENOUGH
from eha_core.diagnosis.result import Diagnosis
from eha_core.report.finding import counted, names_listed
from eha_core.report.rivals_picture import IN_FULL, evidence_picture, named, rung
from eha_core.report.stage import Stage, Table, adds_physics
from eha_core.report.wording import listed, probable


def stage(diagnosis: Diagnosis) -> Stage:
    """The sets of effects that were fitted, and how far the winner is ahead."""
    sentences = [
        "A linear model of all effects at once predicts which sets explain most. Those were fitted with every nominal"
        " parameter free. An effect has to gain more than its own parameters cost."
    ]
    pictures = (evidence_picture(diagnosis),) if diagnosis.rivals else ()
    if not pictures:
        sentences.append("The predicted gain of every effect in the catalogue is too small; none was fitted.")
    elif not adds_physics(diagnosis):
        sentences.append(_why_none(diagnosis))
    if diagnosis.alternatives:
        rivals = listed([named(alternative.effects) for alternative in diagnosis.alternatives])
        sentences.append(f"In this recording it cannot be distinguished from {rivals}: see the next experiment.")
    return Stage("name", "Name", _headline(diagnosis), tuple(sentences), pictures, _sets(diagnosis))


def _sets(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """Table of the sets that together have most of the probability."""
    chosen = {effect.id for effect in diagnosis.effects}
    rows = tuple((rung(set(each.effects), chosen), probable(each.probability)) for each in diagnosis.sets)
    together = sum(each.probability for each in diagnosis.sets)
    title = "Sets that together have 95 % of the probability"
    if together < CERTAINTY:
        title = f"Sets that together have {together:.0%} of the probability; the rest is that of sets not found"
    return (Table(("set", "probability"), rows, title),) if rows else ()


def _why_none(diagnosis: Diagnosis) -> str:
    """Why no effect was named although some were fitted."""
    gained = any(effects and score > ENOUGH for effects, score in diagnosis.rivals)
    missed = "those that do are at a prior bound or do not on held-out data" if gained else "none does"
    return f"To be named, one has to gain {ENOUGH:.0f}; {missed}."


def _headline(diagnosis: Diagnosis) -> str:
    count = len(diagnosis.effects)
    winner = (
        named(tuple(effect.id for effect in diagnosis.effects))
        if count <= IN_FULL
        else f"{counted(count)} effects together: {names_listed(diagnosis)}"
    )
    return {
        "consistent": "Nothing needs to be added to the model",
        "parameters": "Other parameter values suffice; no physics has to be added",
        "missing_physics": f"The evidence points to {winner}",
        "ambiguous": f"The best explanation is {winner}, but it is not the only one",
        "unknown_physics": f"The evidence points to {winner} and a law that is not in the catalogue"
        if count
        else "Nothing in the catalogue explains it",
    }[diagnosis.verdict]
