"""Stage 5, model: what was found, with its parameters and their uncertainty."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.effects import SITES
from eha_core.quantities import interval, scale_for, with_deviation
from eha_core.report.finding import effects_listed
from eha_core.report.picture import LABELS, Dots, Group, Intervals, Panel, Picture
from eha_core.report.series import spread, strongest_dependence
from eha_core.report.stage import SURE, Stage, Table
from eha_core.report.stages.locate import NOISE
from eha_core.report.wording import (
    VARIABLE_UNITS,
    capital,
    channel_title,
    effect_title,
    sentence,
    variable_title,
    words,
)

WITHOUT = "It was read off the balances of measured channels; the simulation goes on without it."


def stage(diagnosis: Diagnosis) -> Stage:
    """The named physics in equations and numbers, or the recovered law as a curve."""
    if diagnosis.unknown:
        law = diagnosis.unknown
        told = (
            f"The law was recovered from the data; it explains {law.r_squared:.1%} of the mismatch.",
            WITHOUT if diagnosis.bent else "",
            "As a formula, it reads:" if law.expression else "No simple formula follows its curve.",
        )
        headline = f"A law over {law.function_of} is missing"
        return Stage("model", "Model", headline, told, code=law.expression)
    if not diagnosis.effects:
        ending = "with the fitted parameters" if diagnosis.verdict == "parameters" else "as it was given"
        return Stage("model", "Model", f"The model stands {ending}", ("No physics was added.",))
    sentences = (
        *(sentence(one.statement) for one in diagnosis.effects),
        "Started with fitted.yaml, the simulator has this physics.",
        *(f"{capital(effect_title(one.id))} acts {SITES[one.site].words}." for one in diagnosis.effects),
    )
    code = "\n".join(one.equation for one in diagnosis.effects)
    pictures = tuple(one for one in (_collapse(diagnosis), _intervals(diagnosis)) if one)
    return Stage("model", "Model", capital(effects_listed(diagnosis)), sentences, pictures, (_table(diagnosis),), code)


def _collapse(diagnosis: Diagnosis) -> Picture | None:
    """The channel whose mismatch hung most on a variable, over that variable, without and with the physics."""
    pictures, fits = diagnosis.pictures, diagnosis.held_out or diagnosis.training
    found = []
    for name, after in pictures.after.items():
        time, measured, noise = pictures.time[name], pictures.measured[name], fits[name].noise
        old, new = (measured - pictures.calibrated[name]) / noise, (measured - after) / noise
        dependence = strongest_dependence(time, old, pictures.variables)
        if dependence:
            taken = 1.0 - float(np.mean(new**2)) / max(float(np.mean(old**2)), 1e-30)
            found.append((taken * dependence.share, name, dependence, old, new))
    if not found:
        return None
    _, name, dependence, old, new = max(found, key=lambda one: one[0])
    scale = scale_for(VARIABLE_UNITS[dependence.variable], float(np.abs(dependence.at).max()))
    x, old, new = spread(dependence.at / scale.factor, old, new)
    marks = (NOISE, Dots(x, old, "calibrated", LABELS["calibrated"]), Dots(x, new, "after", LABELS["after"]))
    panel = Panel(marks, f"{variable_title(dependence.variable)} [{scale.unit}]", "in units of noise", height=330)
    title = f"Mismatch of the {channel_title(name)}, without and with the added physics"
    return Picture("5-model", (Group((panel,)),), title=title, caption="What the added physics takes away.")


def _intervals(diagnosis: Diagnosis) -> Picture | None:
    rows = [
        (f"{effect_title(effect.id)}: {words(name)}", one)
        for effect in diagnosis.effects
        for name, one in effect.parameters.items()
        if one.value != 0.0 and np.isfinite(one.std)
    ]
    if not rows:
        return None
    reach = np.array([100.0 * SURE * one.std / abs(one.value) for _, one in rows])
    texts = tuple(with_deviation(one.value, one.std, one.unit) for _, one in rows)
    names = tuple(name for name, _ in rows)
    intervals = Intervals(names, np.zeros(len(rows)), reach, ("after",) * len(rows), texts)
    limit = float(np.clip(1.15 * reach.max(), 1.0, 150.0))
    panel = Panel((intervals,), "95 % interval [% of the value]", height=60 + 34 * len(rows), x_range=(-limit, limit))
    return Picture("5-model-intervals", (Group((panel,)),), title="How well its parameters are known")


def _table(diagnosis: Diagnosis) -> Table:
    rows = []
    for effect in diagnosis.effects:
        for name, one in effect.parameters.items():
            deviation = with_deviation(one.value, one.std, one.unit)
            rows.append((f"{effect.id}.{name}", deviation, interval(one.value, one.std, one.unit, SURE)))
    return Table(
        ("parameter", "value (± standard deviation)", "95 % interval"), tuple(rows), "Parameters of the added physics"
    )
