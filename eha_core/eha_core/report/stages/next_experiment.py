"""Stage 7, next experiment: the test that would separate what this recording cannot."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.result import Diagnosis
from eha_core.report.picture import Group, Line, Panel, Picture
from eha_core.report.quantities import scale_for
from eha_core.report.series import thinned
from eha_core.report.stages.stage import Stage
from eha_core.report.wording import sentence, words
from eha_core.signals import make_signal


def stage(diagnosis: Diagnosis) -> Stage:
    """The proposed test as the reference node's parameters, and its voltage."""
    experiment = diagnosis.next_experiment
    if experiment is None:
        sentences = ("No explanations are left that a further test would have to tell apart.",)
        return Stage("next", "Next experiment", "No further experiment is needed", sentences)
    reference = experiment.reference
    code = "\n".join(["reference:", "  ros__parameters:", *(f"    {key}: {value}" for key, value in reference.items())])
    return Stage(
        "next",
        "Next experiment",
        f"One more test would tell {' from '.join(words(one) for one in experiment.separates[:2])}",
        (
            sentence(experiment.statement),
            "Give these parameters to the reference node, record, and diagnose both recordings together.",
        ),
        (_picture(reference, experiment.duration),),
        code=code,
    )


def _picture(reference: Mapping[str, object], duration: float) -> Picture:
    name = str(reference["signal"])
    parameters = {key.removeprefix(f"{name}."): value for key, value in reference.items() if key.startswith(f"{name}.")}
    time: Array = np.linspace(0.0, duration, 20_001, dtype=np.float64)
    voltage: Array = np.asarray(make_signal(name, parameters).value(time), dtype=np.float64)
    scale = scale_for("V", float(np.abs(voltage).max()))
    x, y = thinned(time, voltage / scale.factor)
    panel = Panel((Line(x, y, "after", "", 1.4),), "time [s]", scale.unit, "Voltage command", 230)
    return Picture("7-next-experiment", (Group((panel,)),), caption="The proposed voltage.")
