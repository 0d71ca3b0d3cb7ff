"""Stage 2, calibrate: what the nominal equations can do with their own parameters free."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis, FittedParameter
from eha_core.quantities import quantity, with_deviation
from eha_core.report.picture import Group, Intervals, Panel, Picture
from eha_core.report.stage import SURE, Stage, Table
from eha_core.report.wording import listed, sentence, told_errors, words

MOST_NAMED = 4
"""Changed parameters that the headline names; more are counted."""

UNCHANGED_SEEN = 50.0
"""Per cent; wider intervals of parameters that did not change run out of the picture."""


def stage(diagnosis: Diagnosis) -> Stage:
    """How far wrong values alone explain the recording."""
    changed = [one for one in diagnosis.parameters if one.changed]
    if len(changed) > MOST_NAMED:
        headline = f"{len(changed)} parameters of the nominal model have to change"
    elif changed:
        names = listed([words(one.name) for one in changed])
        verb = "differs" if len(changed) == 1 else "differ"
        headline = f"{names[:1].upper()}{names[1:]} {verb} from the nominal model"
    else:
        headline = "No parameter of the nominal model has to change"
    sentences = [
        "Before any physics is called missing, the parameters of the nominal equations are set free within their"
        " bounds, so that a wrong value is not taken for a missing effect.",
        sentence(told_errors(diagnosis, "rmse_before", "rmse_calibrated", "calibration alone")),
    ]
    held = [one for one in diagnosis.parameters if one.note]
    if held:
        stay = "it stays near its nominal value" if len(held) == 1 else "they stay near their nominal values"
        sentences.append(f"This recording says little about {listed([words(one.name) for one in held])}; {stay}.")
    if diagnosis.biased and changed:
        sentences.append("What is missing may have biased these values: do not take them for the rig's.")
    picture = _picture(diagnosis.parameters)
    return Stage(
        "calibrate", "Calibrate", headline, tuple(sentences), (picture,) if picture else (), (_table(diagnosis),)
    )


def _picture(parameters: tuple[FittedParameter, ...]) -> Picture | None:
    shown = [one for one in parameters if one.nominal != 0.0]
    if not shown:
        return None
    shown.sort(key=lambda one: (not one.changed, bool(one.note)))
    size = np.array([abs(one.nominal) for one in shown])
    departure = 100.0 * (np.array([one.fitted - one.nominal for one in shown])) / size
    reach = 100.0 * SURE * np.nan_to_num(np.array([one.std for one in shown]), posinf=0.0) / size
    far = np.abs(departure) + np.minimum(reach, 100.0)
    changed = np.array([one.changed for one in shown])
    limit = 1.15 * max([2.0, *far[changed], *np.minimum(far[~changed], UNCHANGED_SEEN)])
    roles = tuple("after" if one.changed else "other" for one in shown)
    texts = tuple(
        f"{with_deviation(one.fitted, one.std, one.unit)}, nominal {quantity(one.nominal, one.unit)}" for one in shown
    )
    marks = (Intervals(tuple(words(one.name) for one in shown), departure, reach, roles, texts),)
    panel = Panel(marks, "departure from the nominal value [%]", height=60 + 24 * len(shown), x_range=(-limit, limit))
    caption = (
        "Fitted parameters of the final model as departures from nominal, with 95 % intervals; changed ones in colour."
        " An interval that ends at the plot's edge goes on beyond it."
    )
    return Picture("2-calibrate", (Group((panel,)),), caption=caption)


def _table(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (
            words(one.name),
            quantity(one.nominal, one.unit),
            with_deviation(one.fitted, one.std, one.unit),
            "changed" if one.changed else one.note or "as nominal",
        )
        for one in diagnosis.parameters
    )
    return Table(("parameter", "nominal", "fitted (± standard deviation)", ""), rows, "All fitted parameters")
