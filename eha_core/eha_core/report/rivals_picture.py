"""The ladder of evidence: how far each hypothesis is behind the best, and what was screened out."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.criteria import TIE
from eha_core.diagnosis.result import Diagnosis
from eha_core.effects import effect_title, effects
from eha_core.quantities import RAISED
from eha_core.report.finding import counted
from eha_core.report.picture import Bars, Group, Panel, Picture, Upright, label_lines
from eha_core.report.wording import listed

SHOWN = 12

IN_FULL = 2
"""Effects of a hypothesis that are listed; a larger set is listed by how it differs from the one that was named."""

LINE = 16
"""Pixels of a line of a hypothesis' label."""

STUB = 1.6
"""Length of the best hypothesis' bar, as a factor on the logarithmic axis."""

STOPPED_SHORT = 100.0
"""Evidence behind the recalibrated model from which a hypothesis' fit has not converged: its parameters cost less
(assumed)."""

COLOURED = "Teal: what was named; ochre: what cannot be distinguished from it."
UNNAMED = "None of these explains enough of the mismatch to be named."
STOPPED = " A hypothesis that is worse than the model that adds nothing was dropped before its fit had converged."

MILLION = 1e6

NULL = "nothing added (recalibrated model)"


def named(ids: tuple[str, ...]) -> str:
    """A hypothesis by its effects."""
    return " + ".join(map(effect_title, ids)) or "nothing added"


def rung(ids: set[str], chosen: set[str]) -> str:
    """A hypothesis by its effects; a large set by how it differs from the one that was named."""
    if len(ids) == 1 < len(chosen):
        return f"{named(tuple(ids))} alone"
    if len(ids) <= IN_FULL:
        return named(tuple(sorted(ids)))
    if ids == chosen:
        return f"the {counted(len(chosen))} named effects"
    if chosen & ids and len(chosen - ids) == len(ids - chosen) == 1:
        (lost,), (other,) = chosen - ids, ids - chosen
        return f"{effect_title(other)} in place of {effect_title(lost)}"
    lacks = [f"without {title}" for title in map(effect_title, sorted(chosen - ids))]
    more = [f"with {title}" for title in map(effect_title, sorted(ids - chosen))]
    return f"the named effects {listed([*lacks, *more])}" if chosen & ids else named(tuple(sorted(ids)))


def evidence_picture(diagnosis: Diagnosis, most: int = SHOWN, name: str = "4-name", title: str = "") -> Picture:
    """How far each hypothesis is behind the best, on a logarithmic axis; the model that adds nothing is among them."""
    best = float(diagnosis.rivals[0][1])
    chosen = {effect.id for effect in diagnosis.effects}
    ranked = [(rung(set(ids), chosen), set(ids), score) for ids, score in diagnosis.rivals[:most]]
    if all(ids for _, ids, _ in ranked):
        ranked.append((NULL, set(), 0.0))
    ranked.sort(key=lambda rival: -rival[2])
    top = max(best, 0.0)
    behind = np.array([top - score for _, _, score in ranked])
    tied = [set(alternative.effects) for alternative in diagnosis.alternatives]
    unnamed = diagnosis.verdict == "unknown_physics" and not chosen
    roles = tuple(
        "after" if ids == chosen and not unnamed else "calibrated" if ids in tied else "other" for _, ids, _ in ranked
    )
    texts = tuple(behind_in_words(gap) for gap in behind)
    short = min(score for _, _, score in ranked) < -STOPPED_SHORT
    rungs = Bars(tuple(label for label, _, _ in ranked), np.log10(np.maximum(behind, 1.0) * STUB), roles, texts)
    decades = range(int(np.ceil(np.log10(max(float(behind.max()), 10.0 * TIE)))) + 1)
    ticks = tuple((exponent + np.log10(STUB), _decade(exponent)) for exponent in decades)
    panel = Panel(
        (Upright(float(np.log10(TIE * STUB)), "distinguished"), rungs),
        "evidence behind the best (log scale)",
        height=50 + max(30, LINE * max(len(label_lines(label)) for label, _, _ in ranked)) * len(ranked),
        x_range=(0.0, 1.45 * (decades[-1] + np.log10(STUB))),
        x_ticks=ticks,
    )
    caption = (
        "Evidence is the reduction of χ² minus the cost of the added parameters; the bars show how far each hypothesis"
        " is behind the best. Left of the dotted line, it cannot be distinguished from the best."
        f" {UNNAMED if unnamed else COLOURED}"
        f"{STOPPED if short else ''} {_screened(diagnosis)}"
    )
    return Picture(name, (Group((panel,)),), title=title, caption=caption)


def _decade(exponent: int) -> str:
    return f"{10**exponent:,}" if exponent < 4 else f"10{str(exponent).translate(RAISED)}"


def behind_in_words(value: float) -> str:
    """How far a hypothesis is behind the best: "15 behind"."""
    if value <= 0.0:
        return "best"
    return f"{value:,.0f} behind" if value < MILLION else f"{value / MILLION:.3g} million behind"


def _screened(diagnosis: Diagnosis) -> str:
    """Which effects were never refitted, and why."""
    refitted = {effect_id for ids, _ in diagnosis.rivals for effect_id in ids}
    left = [effect for effect in effects() if effect.named and effect.id not in refitted]
    seen = {f"measured_{channel}" for channel in diagnosis.channels}
    blind = [effect.id for effect in left if effect.needs and not set(effect.needs) <= seen]
    weak = [effect.id for effect in left if effect.id not in blind]
    weakly = listed(list(map(effect_title, weak)))
    remarks = [f"In none of these sets, because they gain too little: {weakly}."]
    if blind:
        remarks.append(f"Not tried, as their channels were not recorded: {listed(list(map(effect_title, blind)))}.")
    return " ".join(remarks if weak else remarks[1:])
