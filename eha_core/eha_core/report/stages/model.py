"""Stage 5, model: the named effects or the recovered law, with parameters and their uncertainty."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.result import Diagnosis, NamedEffect, UnknownLaw
from eha_core.effects import SITES, effect_title
from eha_core.quantities import interval, scale_for, with_deviation
from eha_core.report.claims import judged
from eha_core.report.contribution import contribution, step_table
from eha_core.report.finding import IN_A_SENTENCE, effects_listed, identified_parameters, missing, names_listed
from eha_core.report.first_screen import law_panel
from eha_core.report.laws import Law
from eha_core.report.picture import LABELS, Cells, Dots, Group, Intervals, Panel, Picture
from eha_core.report.series import spread, strongest_dependence
from eha_core.report.stage import SURE, Part, Stage, Table
from eha_core.report.stages.locate import NOISE
from eha_core.report.wording import (
    VARIABLE_UNITS,
    capital,
    channel_title,
    listed,
    probable,
    sentence,
    variable_title,
    words,
)

WITHOUT = "It was found from the equations of the measured channels; the simulation does not include it."


LAW_HEIGHT = 240  # pixels

CELL = 22
"""Pixels of a row of correlations."""

STRONG_CORRELATION = 0.9
"""Correlation from which two parameters count as identified only together (a common rule of thumb)."""

MOST_PAIRS = 4


def stage(diagnosis: Diagnosis, found: Mapping[str, Law]) -> Stage:
    """Each named effect in words, equation, numbers and law; or the recovered law as a curve."""
    if not diagnosis.effects:
        return _without_names(diagnosis)
    pictures = tuple(
        picture for picture in (_collapse(diagnosis), _intervals(diagnosis), correlations(diagnosis)) if picture
    )
    named = effects_listed(diagnosis) if len(diagnosis.effects) <= IN_A_SENTENCE else names_listed(diagnosis)
    headline, facts, formula = _recovered(diagnosis.unknown, diagnosis.biased) if diagnosis.unknown else (named, (), "")
    return Stage(
        "model",
        "Model",
        capital(headline),
        (*facts, "Started with fitted.yaml, the simulator has this physics.", *_strong_correlations(diagnosis)),
        pictures,
        (_table(diagnosis), *step_table(diagnosis)),
        parts=tuple(_part(diagnosis, place, effect, found) for place, effect in enumerate(diagnosis.effects, start=1)),
        code=formula,
    )


def _without_names(diagnosis: Diagnosis) -> Stage:
    """The recovered law alone, or the model without added physics."""
    if diagnosis.unknown:
        headline, facts, formula = _recovered(diagnosis.unknown, diagnosis.biased)
        return Stage("model", "Model", headline, facts, code=formula)
    ending = "with the fitted parameters" if diagnosis.verdict == "parameters" else "as it was given"
    return Stage("model", "Model", f"The model stands {ending}", ("No physics was added.",))


def _recovered(law: UnknownLaw, biased: bool) -> tuple[str, tuple[str, ...], str]:
    """The headline, the sentences and the formula of a recovered law."""
    details = (
        f"The law was recovered from the data; it explains {law.r_squared:.1%} of the mismatch.",
        WITHOUT if biased else "",
        "As a formula, it reads:" if law.expression else "No simple formula follows its curve.",
    )
    return f"A law over {law.function_of} is missing", details, law.expression


def _part(diagnosis: Diagnosis, place: int, effect: NamedEffect, found: Mapping[str, Law]) -> Part:
    """One effect: its statement, values, site, contribution and law."""
    details = missing(effect)
    title = f"{place}. {capital(details.title)}: {', '.join(details.values)}"
    acts = f"It acts {SITES[effect.site].words}. The name is {probable(effect.probability)} probable."
    law = found.get(effect.id)
    panel = replace(law_panel(law, LAW_HEIGHT), title="") if law else None
    pictures = (Picture(f"5-law-{effect.id}", (Group((panel,)),)),) if panel else ()
    sentences = sentence(effect.statement), acts, contribution(diagnosis, effect.id)
    return Part(title, sentences, pictures, effect.equation)


def correlations(diagnosis: Diagnosis) -> Picture | None:
    """The correlation matrix of the fitted parameters' errors; None of fewer than two."""
    names, matrix = diagnosis.correlation.names, diagnosis.correlation.matrix
    if len(names) < 2:
        return None
    titles = tuple(_parameter_title(name) for name in names)
    panel = Panel((Cells(titles, np.array(matrix), -1.0, 1.0),), height=CELL * len(names))
    caption = (
        "Correlation of the fitted parameters' errors. Near 1 or -1, this recording identifies only a combination of"
        " the two, and either may be wrong with the other."
    )
    return Picture("5-model-correlation", (Group((panel,)),), title="What is identified only together", caption=caption)


def _strong_correlations(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The strongly correlated pairs with a parameter of the missing physics, the strongest first, as a sentence."""
    names, matrix = diagnosis.correlation.names, diagnosis.correlation.matrix
    pairs = [
        (abs(matrix[row][column]), names[row], names[column])
        for row in range(len(names))
        for column in range(row)
        if abs(matrix[row][column]) > STRONG_CORRELATION and "." in names[row] + names[column]
    ]
    if not pairs:
        return ()
    shown = [
        f"{_parameter_title(name)} with {_parameter_title(other)} ({size:.2f})"
        for size, name, other in sorted(pairs, reverse=True)[:MOST_PAIRS]
    ]
    return (f"Strongly correlated, and therefore less certain each than together: {listed(shown)}.",)


def _parameter_title(name: str) -> str:
    effect, dot, parameter = name.partition(".")
    return f"{effect_title(effect)}: {words(parameter)}" if dot else words(name)


def _collapse(diagnosis: Diagnosis) -> Picture | None:
    """The mismatch of one channel over the variable on which it depended most, without and with the physics."""
    pictures, fits = diagnosis.pictures, judged(diagnosis)
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
    _, name, dependence, old, new = max(found, key=lambda candidate: candidate[0])
    scale = scale_for(VARIABLE_UNITS[dependence.variable], float(np.abs(dependence.at).max()))
    x, old, new = spread(dependence.at / scale.factor, old, new)
    marks = (NOISE, Dots(x, old, "calibrated", LABELS["calibrated"]), Dots(x, new, "after", LABELS["after"]))
    panel = Panel(marks, f"{variable_title(dependence.variable)} [{scale.unit}]", "in units of noise", height=330)
    title = f"Mismatch of the {channel_title(name)}, without and with the added physics"
    return Picture("5-model", (Group((panel,)),), title=title, caption="The mismatch that the added physics removes.")


def _intervals(diagnosis: Diagnosis) -> Picture | None:
    rows = [
        (f"{effect_title(effect.id)}: {words(name)}", fitted)
        for effect in diagnosis.effects
        for name, fitted in effect.parameters.items()
        if fitted.value != 0.0 and np.isfinite(fitted.std)
    ]
    if not rows:
        return None
    reach = np.array([100.0 * SURE * fitted.std / abs(fitted.value) for _, fitted in rows])
    texts = tuple(with_deviation(fitted.value, fitted.std, fitted.unit) for _, fitted in rows)
    names = tuple(name for name, _ in rows)
    intervals = Intervals(names, np.zeros(len(rows)), reach, ("after",) * len(rows), texts)
    limit = float(np.clip(1.15 * reach.max(), 1.0, 150.0))
    panel = Panel((intervals,), "95 % interval [% of the value]", height=60 + 34 * len(rows), x_range=(-limit, limit))
    return Picture("5-model-intervals", (Group((panel,)),), title="How well its parameters are known")


def _table(diagnosis: Diagnosis) -> Table:
    rows = []
    for effect in diagnosis.effects:
        details = identified_parameters(effect)
        for name, fitted in effect.parameters.items():
            deviation = with_deviation(fitted.value, fitted.std, fitted.unit)
            note = "" if name in details else "not distinguished from zero"
            si = f"{fitted.value:.5g} {fitted.unit.replace('-', '')}".strip()
            rows.append(
                (f"{effect.id}.{name}", deviation, interval(fitted.value, fitted.std, fitted.unit, SURE), si, note)
            )
    headings = ("parameter", "value (± standard deviation)", "95 % interval", "SI", "")
    return Table(headings, tuple(rows), "Parameters of the added physics")
