"""Each effect's contribution: the residuals of the nominal, recalibrated and augmented models, and of the last without
each effect."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eha_core.diagnosis.criteria import LEFT_IN_A_CHANNEL
from eha_core.diagnosis.result import AUGMENTED, NOMINAL, RECALIBRATED, Diagnosis, Residual
from eha_core.effects import SITES, effect_title
from eha_core.quantities import short
from eha_core.report.finding import missing
from eha_core.report.picture import Bars, Group, Panel, Picture, Upright
from eha_core.report.stage import Table
from eha_core.report.wording import capital, channel_title

TITLES = {NOMINAL: "nominal model", RECALIBRATED: "recalibrated, nothing added"}
ROLES = {NOMINAL: "before", RECALIBRATED: "calibrated"}
STUB = 0.012
"""Shortest bar, as a share of the axis; a model at the noise would have none."""

LEAST_DECADES = 2
"""Shortest axis; on a shorter one the number of a model at the noise would be on the dotted line."""

BESIDE = 3 * "\N{EN SPACE}"

ROW, FRAME = 30, 56
"""Pixels of a bar and of the frame around the bars."""


def ladder_picture(diagnosis: Diagnosis) -> Picture | None:
    """The residual of each model, from the nominal one over the set without each of its effects to the complete set."""
    rows = [row for row in _models(diagnosis) if np.isfinite(row[1].overall)]
    if not rows:
        return None
    caption = (
        "RMS residual of each model in units of the noise, all channels together. All but the nominal model are fitted."
        f" The axis begins at the noise. Dotted: {LEFT_IN_A_CHANNEL:g} times the noise; an explanation counts as"
        " complete if every channel is below that and the residual is white."
    )
    title = "Residual, from the nominal model to the complete explanation"
    return Picture("0-ladder", (Group((_bars(rows),)),), title=title, caption=caption)


def _models(diagnosis: Diagnosis) -> list[tuple[str, Residual, str]]:
    """Each model's name, residual and role; those without one effect come before the complete set."""
    rows = [(_title(diagnosis, step.added), step.residual, ROLES.get(step.added, "after")) for step in diagnosis.steps]
    without = [(f"without {effect_title(name)}", left, "other") for name, left in diagnosis.without.items()]
    return [*rows[:2], *without, *rows[2:]]


def _title(diagnosis: Diagnosis, added: str) -> str:
    """A model in words."""
    if added in TITLES:
        return TITLES[added]
    if len(diagnosis.effects) > 1 or diagnosis.without:
        return "with all of them"
    return f"with {effect_title(diagnosis.effects[0].id)}" if diagnosis.effects else "with the recovered law"


def _bars(rows: Sequence[tuple[str, Residual, str]]) -> Panel:
    values = np.array([residual.overall for _, residual, _ in rows])
    decades = max(LEAST_DECADES, int(np.ceil(np.log10(values.max()))))
    end = 1.16 * decades
    lengths = np.maximum(np.log10(np.maximum(values, 1e-3)), STUB * end)
    # right of the dotted line, not on it
    texts = tuple(f"{BESIDE if value < 2.0 else ''}{short(value)}" for value in values)
    bars = Bars(tuple(name for name, _, _ in rows), lengths, tuple(role for _, _, role in rows), texts)
    threshold = Upright(float(np.log10(LEFT_IN_A_CHANNEL)), "")
    ticks = tuple((float(exponent), f"{10**exponent:,}") for exponent in range(decades + 1))
    return Panel(
        (threshold, bars),
        "times the noise (log scale)",
        height=FRAME + ROW * len(rows),
        x_range=(0.0, end),
        x_ticks=ticks,
    )


def effect_table(diagnosis: Diagnosis) -> Table:
    """Each effect in its order: its values, its site, and the residual without it."""
    rows = []
    for effect in diagnosis.effects:
        row = [capital(effect_title(effect.id)), ", ".join(missing(effect).values), SITES[effect.site].words]
        if diagnosis.without:
            row.append(short(diagnosis.without[effect.id].overall))
        rows.append(tuple(row))
    headings: tuple[str, ...] = ("missing effect", "value (95 % interval)", "where")
    if diagnosis.without:
        headings += ("residual without it [×\N{NO-BREAK SPACE}noise]",)
    return Table(headings, tuple(rows), "What is missing, what matters most first")


def step_table(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """The residual of each model in each channel, in units of the noise."""
    if not diagnosis.steps:
        return ()
    names = list(diagnosis.steps[0].residual.times_noise)
    rows = [
        (title, *(short(ratio) for ratio in residual.times_noise.values()), short(residual.overall))
        for title, residual, _ in _models(diagnosis)
    ]
    headings = ("model", *(channel_title(name) for name in names), "all channels")
    return (Table(headings, tuple(rows), "Residual of each model, times the noise"),)


def contribution(diagnosis: Diagnosis, effect: str) -> str:
    """The residual without an effect and with it, in a sentence; empty if not known."""
    left = {step.added: step.residual for step in diagnosis.steps}
    if AUGMENTED not in left:
        return ""
    if effect in diagnosis.without:
        without, fitted = diagnosis.without[effect], "with the others refitted"
    elif [one.id for one in diagnosis.effects] == [effect] and not diagnosis.without:
        without, fitted = left[RECALIBRATED], "with the parameters refitted"
    else:
        return ""
    whole = short(left[AUGMENTED].overall)
    return f"Without it, {fitted}, the residual is {short(without.overall)} times the noise; with it {whole}."
