"""What each effect is worth: the way from the nominal model to the noise, one effect after another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eha_core.diagnosis.criteria import LEFT_IN_A_CHANNEL
from eha_core.diagnosis.result import NOMINAL, RECALIBRATED, Diagnosis, Residual
from eha_core.effects import SITES
from eha_core.quantities import short
from eha_core.report.finding import missing
from eha_core.report.picture import Bars, Group, Panel, Picture, Upright
from eha_core.report.stage import Table
from eha_core.report.wording import capital, channel_title, effect_title

TITLES = {NOMINAL: "nominal model", RECALIBRATED: "recalibrated, nothing added"}
ROLES = {NOMINAL: "before", RECALIBRATED: "calibrated"}
STUB = 0.012
"""Of the axis; what is at the noise would have no bar at all."""

LEAST_DECADES = 2
"""Of the axis; on a shorter one the numbers of what is at the noise stand on the dotted line."""

BESIDE = 3 * "\N{EN SPACE}"

ROW, FRAME = 30, 56
"""Pixels of a bar and of what is about the bars."""


def step_title(added: str) -> str:
    """A step of the way in words."""
    return TITLES.get(added) or f"+ {effect_title(added)}"


def ladder_picture(diagnosis: Diagnosis) -> Picture | None:
    """What each model leaves, from the nominal one to the whole set; and the set without each of its effects."""
    steps = [step for step in diagnosis.steps if np.isfinite(step.residual.overall)]
    if not steps:
        return None
    top = max(step.residual.overall for step in steps)
    rows = [(step_title(step.added), step.residual, ROLES.get(step.added, "after")) for step in steps]
    groups = [Group((_bars(rows, top, "Added one by one"),))]
    ids = [step.added for step in steps if step.added in diagnosis.without]
    if ids:
        whole = ("all of them", steps[-1].residual, "after")
        rest = [(f"without {effect_title(effect)}", diagnosis.without[effect], "other") for effect in ids]
        groups.append(Group((_bars([*rest, whole], top, "Each left out in turn"),)))
    caption = (
        "RMS of what each model leaves over the noise, all channels together. All but the nominal model are fitted. The"
        f" axis begins at the noise. Dotted: {LEFT_IN_A_CHANNEL:g} times the noise; an explanation counts as complete"
        " if every channel is below that and what is left is white."
    )
    title = "What is left, from the nominal model to the noise"
    return Picture("0-ladder", tuple(groups), (1, 1), title, caption)


def _bars(rows: Sequence[tuple[str, Residual, str]], top: float, title: str) -> Panel:
    values = np.array([residual.overall for _, residual, _ in rows])
    decades = max(LEAST_DECADES, int(np.ceil(np.log10(top))))
    end = 1.16 * decades
    lengths = np.maximum(np.log10(np.maximum(values, 1e-3)), STUB * end)
    # beside the dotted line, not on it
    texts = tuple(f"{BESIDE if value < 2.0 else ''}{short(value)}" for value in values)
    bars = Bars(tuple(name for name, _, _ in rows), lengths, tuple(role for _, _, role in rows), texts)
    threshold = Upright(float(np.log10(LEFT_IN_A_CHANNEL)), "")
    ticks = tuple((float(exponent), f"{10**exponent:,}") for exponent in range(decades + 1))
    return Panel(
        (threshold, bars),
        "times the noise (log scale)",
        title=title,
        height=FRAME + ROW * len(rows),
        x_range=(0.0, end),
        x_ticks=ticks,
    )


def effect_table(diagnosis: Diagnosis) -> Table:
    """Each effect in its order: its values, its site, and what is left with it and without it."""
    left = {step.added: step.residual.overall for step in diagnosis.steps}
    rows = []
    for effect in diagnosis.effects:
        row = [capital(effect_title(effect.id)), ", ".join(missing(effect).values), SITES[effect.site].words]
        if diagnosis.without:
            row += [short(left.get(effect.id, np.nan)), short(diagnosis.without[effect.id].overall)]
        rows.append(tuple(row))
    headings: tuple[str, ...] = ("missing effect", "value (95 % interval)", "where")
    if diagnosis.without:
        headings += ("left with it [×\N{NO-BREAK SPACE}noise]", "left without it [×\N{NO-BREAK SPACE}noise]")
    return Table(headings, tuple(rows), "What is missing, what explains most first")


def step_table(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """What each step leaves in each channel, over its noise."""
    if not diagnosis.steps:
        return ()
    names = list(diagnosis.steps[0].residual.times_noise)
    rows = [_step_row(step_title(step.added), step.residual) for step in diagnosis.steps]
    rows += [_step_row(f"all without {effect_title(name)}", residual) for name, residual in diagnosis.without.items()]
    headings = ("model", *(channel_title(name) for name in names), "all channels")
    return (Table(headings, tuple(rows), "What each model leaves, times the noise"),)


def _step_row(title: str, residual: Residual) -> tuple[str, ...]:
    return (title, *(short(ratio) for ratio in residual.times_noise.values()), short(residual.overall))


def worth(diagnosis: Diagnosis, effect: str) -> str:
    """What an effect takes away where it is added, and what is left without it, in a sentence; empty if not known."""
    order = [step.added for step in diagnosis.steps]
    if effect not in order:
        return ""
    place = order.index(effect)
    before, after = (diagnosis.steps[at].residual.overall for at in (place - 1, place))
    change = "takes what is left from" if after < before else "changes what is left from"
    said = f"Added to {_model(order, place - 1)}, it {change} {short(before)} to {short(after)} times the noise."
    if effect in diagnosis.without:
        alone = short(diagnosis.without[effect].overall)
        said += f" Without it, the others fitted again, {alone} times the noise are left."
    return said


def _model(order: Sequence[str], place: int) -> str:
    effects = order[2 : place + 1]
    if not effects:
        return "the recalibrated model"
    return f"the model with {effect_title(effects[0])}" if len(effects) == 1 else "the model with those above"
