"""Stage 7, next experiment: the test that would separate explanations which this recording cannot."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.effects import effect_title
from eha_core.identification.numbers import Array
from eha_core.quantities import scale_for
from eha_core.report.experiment_file import FILE, channels_to_record, commands
from eha_core.report.picture import Group, Line, Panel, Picture
from eha_core.report.series import thinned
from eha_core.report.stage import Stage
from eha_core.report.wording import channel_title, listed, sentence
from eha_core.signals import make_signal, of_reference


def stage(diagnosis: Diagnosis) -> Stage:
    """The proposed test as the reference node's parameters, and its voltage."""
    experiment = diagnosis.next_experiment
    if experiment is None:
        if diagnosis.verdict in ("ambiguous", "unknown_physics"):
            return Stage("next", "Next experiment", "No test is proposed", ("A longer or faster test may show more.",))
        sentences = ("There are no rival explanations that a further test would have to distinguish.",)
        return Stage("next", "Next experiment", "No further experiment is needed", sentences)
    reference = experiment.reference
    if not reference:
        return Stage("next", "Next experiment", "No test is proposed", (sentence(experiment.statement),))
    recorded = listed([channel_title(name) for name in channels_to_record(diagnosis, experiment)])
    return Stage(
        "next",
        "Next experiment",
        f"One more test would distinguish {' from '.join(effect_title(effect) for effect in experiment.separates[:2])}",
        (
            sentence(experiment.statement),
            f"It lasts {experiment.duration:g} s; record {recorded}.",
            f"{FILE} beside this page is the test for the reference node. Then diagnose both recordings together:",
        ),
        (_picture(reference, experiment.duration),),
        code=commands(experiment),
    )


def _picture(reference: Mapping[str, object], duration: float) -> Picture:
    time: Array = np.linspace(0.0, duration, 20_001, dtype=np.float64)
    voltage: Array = np.asarray(make_signal(*of_reference(reference)).value(time), dtype=np.float64)
    scale = scale_for("V", float(np.abs(voltage).max()))
    x, y = thinned(time, voltage / scale.factor)
    panel = Panel((Line(x, y, "after", "", 1.4),), "time [s]", scale.unit, "Voltage command", 230)
    return Picture("7-next-experiment", (Group((panel,)),), caption="The proposed voltage.")
