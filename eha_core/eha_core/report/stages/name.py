"""Stage 4, name: the hypotheses compared."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.diagnosis.tournament import ENOUGH, TIE
from eha_core.effects import effects
from eha_core.quantities import RAISED
from eha_core.report.finding import IN_A_SENTENCE, counted, names_listed
from eha_core.report.picture import Bars, Group, Panel, Picture, Upright
from eha_core.report.stage import Stage, adds_physics
from eha_core.report.wording import effect_title, listed

SHOWN = 12

STUB = 1.6
"""How long the bar of what is not behind at all is drawn, as a factor on the logarithmic axis."""

MILLION = 1e6

NULL = "nothing added (recalibrated model)"


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
    return " + ".join(map(effect_title, effects)) or "nothing added"


def _headline(diagnosis: Diagnosis) -> str:
    count = len(diagnosis.effects)
    winner = (
        named(tuple(one.id for one in diagnosis.effects))
        if count <= IN_A_SENTENCE
        else f"{counted(count)} effects together: {names_listed(diagnosis)}"
    )
    return {
        "consistent": "Nothing needs to be added to the model",
        "parameters": "Other parameter values suffice; no physics has to be added",
        "missing_physics": f"The evidence points to {winner}",
        "ambiguous": f"The best explanation is {winner}, but it is not the only one",
        "unknown_physics": "Nothing in the catalogue explains it",
    }[diagnosis.verdict]


def _rung(effects: set[str], chosen: set[str]) -> str:
    """A hypothesis by its effects; a large set by how it differs from the one that was named."""
    if len(effects) <= IN_A_SENTENCE:
        return named(tuple(sorted(effects)))
    if effects == chosen:
        return f"the {counted(len(chosen))} named effects"
    lacks = [f"without {effect_title(one)}" for one in sorted(chosen - effects)]
    more = [f"with {effect_title(one)}" for one in sorted(effects - chosen)]
    return f"the named effects {listed([*lacks, *more])}" if chosen & effects else named(tuple(sorted(effects)))


def _picture(diagnosis: Diagnosis) -> Picture:
    """How far each hypothesis is behind the best, on a logarithmic axis; the model that adds nothing is among them."""
    best = float(diagnosis.rivals[0][1])
    chosen = {one.id for one in diagnosis.effects}
    ranked = [(_rung(set(effects), chosen), set(effects), score) for effects, score in diagnosis.rivals[:SHOWN]]
    if all(effects for _, effects, _ in ranked):
        ranked.append((NULL, set(), 0.0))
    ranked.sort(key=lambda one: -one[2])
    top = max(best, 0.0)
    behind = np.array([top - score for _, _, score in ranked])
    tied = [set(one.effects) for one in diagnosis.alternatives]
    roles = tuple(
        "after" if effects == chosen else "calibrated" if effects in tied else "other" for _, effects, _ in ranked
    )
    texts = tuple("best" if one <= 0.0 else f"{_large(one)} behind" for one in behind)
    rungs = Bars(tuple(name for name, _, _ in ranked), np.log10(np.maximum(behind, 1.0) * STUB), roles, texts)
    decades = range(int(np.ceil(np.log10(max(float(behind.max()), 10.0 * TIE)))) + 1)
    ticks = tuple((exponent + np.log10(STUB), _decade(exponent)) for exponent in decades)
    panel = Panel(
        (Upright(float(np.log10(TIE * STUB)), "told apart"), rungs),
        "evidence behind the best (log scale)",
        height=50 + 30 * len(ranked),
        x_range=(0.0, 1.45 * (decades[-1] + np.log10(STUB))),
        x_ticks=ticks,
    )
    caption = (
        "Evidence is the gain in χ² less the cost of freedom, here as how far each hypothesis is behind the best; left"
        " of the dotted line it is not told apart. In blue: what was named; in ochre: what this recording does not tell"
        f" from it. {_screened(diagnosis)}"
    )
    return Picture("4-name", (Group((panel,)),), caption=caption)


def _decade(exponent: int) -> str:
    return f"{10**exponent:,}" if exponent < 4 else f"10{str(exponent).translate(RAISED)}"


def _large(value: float) -> str:
    return f"{value:,.0f}" if value < MILLION else f"{value / MILLION:.3g} million"


def _screened(diagnosis: Diagnosis) -> str:
    """Which effects were never refitted, and why."""
    refitted = {effect for effects, _ in diagnosis.rivals for effect in effects}
    left = [effect for effect in effects() if effect.named and effect.id not in refitted]
    seen = {f"measured_{name}" for name in diagnosis.channels}
    blind = [effect.id for effect in left if effect.needs and not set(effect.needs) <= seen]
    weak = [effect.id for effect in left if effect.id not in blind]
    told = [f"Screened out, as a score test says they would gain too little: {listed(list(map(effect_title, weak)))}."]
    if blind:
        told.append(f"Not tried, as their channels were not recorded: {listed(list(map(effect_title, blind)))}.")
    return " ".join(told if weak else told[1:])
