"""The three answers at the top of the page: how much closer the model comes, the residual, and how sure it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from eha_core.diagnosis.criteria import TIE
from eha_core.diagnosis.result import Diagnosis
from eha_core.effects import effect_title
from eha_core.quantities import quantity, short
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import judged, representative_channel, residual_headline, residual_in_words
from eha_core.report.rivals_picture import behind_in_words, named, rung
from eha_core.report.wording import channel_title, listed


@dataclass(frozen=True)
class KeyFigure:
    """A question, its answer in a few characters, and what the answer rests on."""

    question: str
    answer: str
    basis: str


def key_figures(diagnosis: Diagnosis) -> tuple[KeyFigure, ...]:
    """The error with and without the physics, the residual, and the other explanations, as far as they are known."""
    return tuple(key_figure for part in (_better, _left, _sure) for key_figure in part(diagnosis))


def _each_is_needed(diagnosis: Diagnosis) -> Iterator[KeyFigure]:
    """The residual without the effect that matters least; nothing if it is no larger than with all."""
    if not diagnosis.without:
        return
    name, rest = min(diagnosis.without.items(), key=lambda item: item[1].overall)
    whole = diagnosis.steps[-1].residual.overall
    if rest.overall > whole:
        yield KeyFigure(
            "How sure?",
            "Each effect is needed",
            f"Without the one that matters least, {effect_title(name)}, and with the others refitted, the residual is"
            f" {short(rest.overall)} times the noise; with all of them {short(whole)}.",
        )


def _better(diagnosis: Diagnosis) -> Iterator[KeyFigure]:
    name = representative_channel(diagnosis)
    if not name:
        return
    fit, unit = judged(diagnosis)[name], CHANNEL_KINDS[name].unit
    where = "on held-out data" if diagnosis.held_out else "on the training data"
    noise = f"{where}; the sensor's noise is {quantity(fit.noise, unit)}."
    if diagnosis.verdict == "consistent":  # there is no better model to hold beside the nominal one
        error = f"RMS error of the {channel_title(name)}, nominal model, {noise}"
        yield KeyFigure("How close is the model?", quantity(fit.rmse_before, unit), error)
        return
    yield KeyFigure(
        "How much better?",
        f"{quantity(fit.rmse_before, unit)} → {quantity(fit.rmse_after, unit)}",
        f"RMS error of the {channel_title(name)}, nominal model and final model, {noise}",
    )


def _left(diagnosis: Diagnosis) -> Iterator[KeyFigure]:
    basis = residual_in_words(diagnosis)
    if basis:
        answer = residual_headline(diagnosis).removeprefix("The residual is ")
        yield KeyFigure("How large is the residual?", f"{answer[:1].upper()}{answer[1:]}", basis)


def _sure(diagnosis: Diagnosis) -> Iterator[KeyFigure]:
    """How far the named effects are ahead of another explanation with as many effects, or of the set without one."""
    if diagnosis.alternatives:
        rivals = listed([named(alternative.effects) for alternative in diagnosis.alternatives])
        yield KeyFigure("How sure?", "Not the only explanation", f"It cannot be distinguished from {rivals}.")
        return
    if diagnosis.effects and diagnosis.unknown:  # its score is not among those of the catalogue's sets
        yield from _each_is_needed(diagnosis)
        return
    chosen = {effect.id for effect in diagnosis.effects}
    scores = [(set(effects), float(score)) for effects, score in diagnosis.rivals]
    own = max((score for effects, score in scores if effects == chosen), default=float("nan"))
    others = [(effects, score) for effects, score in scores if effects != chosen and len(effects) >= len(chosen)]
    if not chosen or not np.isfinite(own):
        return
    if not others:
        yield from _each_is_needed(diagnosis)
        return
    nearest, score = max(others, key=lambda rival: rival[1])
    if own - score < TIE:  # an ambiguous verdict would say so; a rival at a prior bound does not count
        return
    yield KeyFigure(
        "How sure?",
        f"Next explanation {behind_in_words(own - score)}",
        f"In χ² minus the cost of parameters; {TIE:g} distinguishes two. Next: {rung(nearest, chosen)}."
        f" Nothing added: {behind_in_words(own)}.",
    )
