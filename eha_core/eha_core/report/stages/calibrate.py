"""Stage 2, calibrate: how well the nominal equations fit with their own parameters free."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis, FittedParameter
from eha_core.quantities import quantity, with_deviation
from eha_core.report.claims import calibration_alone
from eha_core.report.picture import Group, Intervals, Panel, Picture
from eha_core.report.stage import SURE, Stage, Table
from eha_core.report.wording import listed, words

MOST_NAMED = 4
"""Changed parameters that the headline names; more are counted."""

UNCHANGED_SEEN = 50.0
"""Per cent; wider intervals of unchanged parameters are cut off at the plot's edge."""


def stage(diagnosis: Diagnosis) -> Stage:
    """How much of the mismatch other parameter values alone explain."""
    changed = [parameter for parameter in diagnosis.parameters if parameter.changed]
    if len(changed) > MOST_NAMED:
        headline = f"{len(changed)} parameters of the nominal model have to change"
    elif changed:
        names = listed([words(parameter.name) for parameter in changed])
        verb = "differs" if len(changed) == 1 else "differ"
        headline = f"{names[:1].upper()}{names[1:]} {verb} from the nominal model"
    else:
        headline = "No parameter of the nominal model has to change"
    sentences = [
        "Before any physics is called missing, the parameters of the nominal equations are fitted within their prior"
        " bounds, so that a wrong value is not taken for a missing effect.",
        calibration_alone(diagnosis),
    ]
    held = [parameter for parameter in diagnosis.parameters if parameter.note]
    if held:
        stay = "it stays near its nominal value" if len(held) == 1 else "they stay near their nominal values"
        sentences.append(
            f"This recording hardly identifies {listed([words(parameter.name) for parameter in held])}; {stay}."
        )
    if diagnosis.biased and changed:
        sentences.append("The missing physics may have biased these values: do not take them for the rig's.")
    picture = _picture(diagnosis.parameters)
    return Stage(
        "calibrate", "Calibrate", headline, tuple(sentences), (picture,) if picture else (), (_table(diagnosis),)
    )


def _picture(parameters: tuple[FittedParameter, ...]) -> Picture | None:
    shown = [parameter for parameter in parameters if parameter.nominal != 0.0]
    if not shown:
        return None
    shown.sort(key=lambda parameter: (not parameter.changed, bool(parameter.note)))
    size = np.array([abs(parameter.nominal) for parameter in shown])
    departure = 100.0 * (np.array([parameter.fitted - parameter.nominal for parameter in shown])) / size
    reach = 100.0 * SURE * np.nan_to_num(np.array([parameter.std for parameter in shown]), posinf=0.0) / size
    far = np.abs(departure) + np.minimum(reach, 100.0)
    changed = np.array([parameter.changed for parameter in shown])
    limit = 1.15 * max([2.0, *far[changed], *np.minimum(far[~changed], UNCHANGED_SEEN)])
    roles = tuple("after" if parameter.changed else "other" for parameter in shown)
    texts = tuple(
        f"{with_deviation(parameter.fitted, parameter.std, parameter.unit)}, nominal"
        f" {quantity(parameter.nominal, parameter.unit)}"
        for parameter in shown
    )
    marks = (Intervals(tuple(words(parameter.name) for parameter in shown), departure, reach, roles, texts),)
    panel = Panel(marks, "departure from the nominal value [%]", height=60 + 24 * len(shown), x_range=(-limit, limit))
    caption = (
        "Fitted parameters of the final model as departures from nominal, with 95 % intervals; changed ones in colour."
        " An interval that ends at the plot's edge continues beyond it."
    )
    return Picture("2-calibrate", (Group((panel,)),), caption=caption)


def _table(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (
            words(parameter.name),
            quantity(parameter.nominal, parameter.unit),
            with_deviation(parameter.fitted, parameter.std, parameter.unit),
            "changed" if parameter.changed else parameter.note or "as nominal",
        )
        for parameter in diagnosis.parameters
    )
    return Table(("parameter", "nominal", "fitted (± standard deviation)", ""), rows, "All fitted parameters")
