"""Stage 4, name: the tournament of hypotheses."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.tournament import ENOUGH
from eha_core.report.picture import Bars, Group, Panel, Picture
from eha_core.report.stages.stage import Stage, adds_physics
from eha_core.report.wording import listed, words

SHOWN = 12


def stage(diagnosis: Diagnosis) -> Stage:
    """Which of the catalogue's effects were tried, and how far the winner is ahead."""
    sentences = [
        "Each effect of the catalogue that promised anything was put into the model, alone and with others, and fitted"
        " again with every nominal parameter free. What it gains has to pay for its extra freedom."
    ]
    pictures = (_picture(diagnosis),) if diagnosis.rivals else ()
    if not pictures:
        sentences.append("No effect of the catalogue promised enough to be fitted.")
    elif not adds_physics(diagnosis):
        sentences.append(f"To be named, one has to gain {ENOUGH:.0f}; none does.")
    if diagnosis.alternatives:
        rivals = listed([named(one.effects) for one in diagnosis.alternatives])
        sentences.append(f"This recording does not tell it from {rivals}: see the next experiment.")
    return Stage("name", "Name", _headline(diagnosis), tuple(sentences), pictures)


def named(effects: tuple[str, ...]) -> str:
    """A hypothesis by its effects."""
    return " + ".join(words(one) for one in effects) or "nothing added"


def _headline(diagnosis: Diagnosis) -> str:
    winner = named(tuple(one.id for one in diagnosis.effects))
    return {
        "consistent": "Nothing needs to be added to the model",
        "parameters": "Other parameter values suffice; no physics has to be added",
        "missing_physics": f"The evidence points to {winner}",
        "ambiguous": f"The best explanation is {winner}, but it is not the only one",
        "unknown_physics": "Nothing in the catalogue explains it",
    }[diagnosis.verdict]


def _picture(diagnosis: Diagnosis) -> Picture:
    rivals = diagnosis.rivals[:SHOWN]
    chosen = {one.id for one in diagnosis.effects}
    tied = [set(one.effects) for one in diagnosis.alternatives]
    roles = tuple(
        "after" if chosen and set(effects) == chosen else "calibrated" if set(effects) in tied else "other"
        for effects, _ in rivals
    )
    scores = np.array([score for _, score in rivals])
    best = float(scores[0])
    texts = (f"{best:,.0f}".replace("-", "−"), *(f"{best - score:,.0f} behind" for score in scores[1:]))
    # hypotheses that fit worse than nothing at all would leave no room for the others
    limit = max(best, ENOUGH)
    bars = Bars(tuple(named(effects) for effects, _ in rivals), np.maximum(scores, 0.0), roles, texts)
    panel = Panel(
        (bars,),
        "evidence",
        height=50 + 36 * len(rivals),
        x_range=(0.0, 1.4 * limit),
    )
    caption = (
        "The tournament. Evidence is the gain in χ² less the cost of freedom. In blue: what was named; in ochre: rivals"
        " that this recording does not tell from it."
    )
    return Picture("4-name", (Group((panel,)),), caption=caption)
