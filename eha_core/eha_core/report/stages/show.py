"""Stage 6, show: the models on data that they were not fitted to."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.numbers import Array
from eha_core.diagnosis.result import Diagnosis
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.picture import LABELS, Band, Group, Line, Mark, Panel, Picture
from eha_core.report.quantities import Scale, scale_for, short
from eha_core.report.series import autocorrelation, pieces
from eha_core.report.stages.stage import Stage, Table, adds_physics, judged_spans
from eha_core.report.wording import channel_title, sentence, told_errors

MODELS = ("before", "calibrated", "after")
LAGS = 60
NOISE_ALONE = 1.1
"""Times the noise; an error below that is taken for noise."""


def stage(diagnosis: Diagnosis) -> Stage:
    """Before, calibrated and after, against the noise floor; and whether what is left is noise."""
    fits = diagnosis.held_out or diagnosis.training
    ratios = [one.rmse_after / one.noise for one in fits.values() if np.isfinite(one.rmse_after)]
    worst = max(ratios, default=float("nan"))
    headline = "What is left is noise" if worst < NOISE_ALONE else f"What is left is up to {worst:.1f} times the noise"
    sentences = (
        "Parts of the recording were kept from the fit, and the models are judged on them.",
        sentence(told_errors(diagnosis, "rmse_before", "rmse_after", "the final model")),
    )
    return Stage(
        "show", "Show", headline, sentences, (_overlays(diagnosis), _whiteness(diagnosis)), (error_table(diagnosis),)
    )


def error_table(diagnosis: Diagnosis) -> Table:
    """RMSE of each channel and model on held-out data, and the noise, in a unit that suits the noise."""
    rows = []
    for name, one in (diagnosis.held_out or diagnosis.training).items():
        scale = scale_for(CHANNEL_KINDS[name].unit, one.noise)
        values = (one.rmse_before, one.rmse_calibrated, one.rmse_after, one.noise)
        rows.append((channel_title(name), *(f"{short(value / scale.factor)}{scale.suffix}" for value in values)))
    title = "RMSE on held-out data" if diagnosis.held_out else "RMSE"
    return Table(("channel", "as given", "calibrated", "with what was found", "noise"), tuple(rows), title)


def _overlays(diagnosis: Diagnosis) -> Picture:
    groups: list[Group] = []
    for name in diagnosis.pictures.after:
        groups += [_whole(diagnosis, name), _close_up(diagnosis, name)]
    caption = (
        "Left: the spans used for judging and the mismatch in them. Right: where the calibrated model is worst."
        " Drawn are the final models; for the errors in the table they were fitted again without these spans."
    )
    return Picture("6-show", tuple(groups), (3, 2), "Measured and modelled", caption)


def _models(diagnosis: Diagnosis, name: str) -> list[tuple[str, Array]]:
    """The models of a channel by role; where nothing was added, the calibrated one is the final one."""
    models = [(role, getattr(diagnosis.pictures, role)) for role in MODELS]
    if not adds_physics(diagnosis):
        del models[MODELS.index("calibrated")]
    return [(role, modelled[name]) for role, modelled in models if name in modelled]


def _scale(diagnosis: Diagnosis, name: str) -> Scale:
    return scale_for(CHANNEL_KINDS[name].unit, float(np.abs(diagnosis.pictures.measured[name]).max()))


def _whole(diagnosis: Diagnosis, name: str) -> Group:
    spans, scale = judged_spans(diagnosis), _scale(diagnosis, name)
    time, measured = diagnosis.pictures.time[name], diagnosis.pictures.measured[name]
    noise = (diagnosis.held_out or diagnosis.training)[name].noise
    largest = max(float(np.abs(measured - modelled).max()) for _, modelled in _models(diagnosis, name))
    fine = scale_for(CHANNEL_KINDS[name].unit, largest)
    values: list[Mark] = [_line(time, measured, "measured", spans, scale.factor)]
    left: list[Mark] = [Band(-2.0 * noise / fine.factor, 2.0 * noise / fine.factor, "noise (2 standard deviations)")]
    for role, modelled in _models(diagnosis, name):
        values.append(_line(time, modelled, role, spans, scale.factor))
        left.append(_line(time, measured - modelled, role, spans, fine.factor))
    title = channel_title(name).capitalize()
    return Group(
        (
            Panel(tuple(values), "time [s]", scale.unit, title, 170),
            Panel(tuple(left), "time [s]", fine.unit, f"{title}: measured less modelled", 190),
        )
    )


def _line(time: Array, values: Array, role: str, spans: tuple[tuple[float, float], ...], factor: float) -> Line:
    x, y = pieces(time, values / factor, spans)
    return Line(x, y, role, LABELS[role], 2.0 if role == "measured" else 1.2)


def _close_up(diagnosis: Diagnosis, name: str) -> Group:
    spans, scale = judged_spans(diagnosis), _scale(diagnosis, name)
    time, measured = diagnosis.pictures.time[name], diagnosis.pictures.measured[name]
    wrong = (measured - diagnosis.pictures.calibrated[name]) ** 2
    inside = [wrong[(time >= start) & (time < end)] for start, end in spans]
    worst = spans[int(np.argmax([part.mean() if len(part) else 0.0 for part in inside]))]
    lines = [_line(time, measured, "measured", (worst,), scale.factor)]
    lines += [_line(time, modelled, role, (worst,), scale.factor) for role, modelled in _models(diagnosis, name)]
    title = f"From {worst[0]:.1f} s to {worst[1]:.1f} s"
    return Group((Panel(tuple(lines), "time [s]", scale.unit, title, 360),))


def _whiteness(diagnosis: Diagnosis) -> Picture:
    pictures, groups = diagnosis.pictures, []
    for name in pictures.after:
        time, measured = pictures.time[name], pictures.measured[name]
        limit = 1.96 / np.sqrt(len(time))
        marks: list[Mark] = [Band(-limit, limit, "where 95 % of white noise lies")]
        for role, modelled in _models(diagnosis, name)[1:]:
            lag, correlation = autocorrelation(time, measured - modelled, LAGS)
            marks.append(Line(1e3 * lag, correlation, role, LABELS[role], 1.8))
        groups.append(
            Group((Panel(tuple(marks), "lag [ms]", "", channel_title(name).capitalize(), 220, y_range=(-0.4, 1.05)),))
        )
    return Picture(
        "6-show-whiteness",
        tuple(groups),
        (1,) * min(3, max(1, len(groups))),
        "Is anything left to explain?",
        "Autocorrelation of the mismatch. White noise stays in the band; a mismatch with a memory is not all noise.",
    )
