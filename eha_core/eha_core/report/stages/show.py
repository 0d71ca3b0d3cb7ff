"""Stage 6, show: the models on data that they were not fitted to."""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.identification.numbers import Array
from eha_core.quantities import Scale, quantity, scale_for, short
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import improvement, judged, residual_headline
from eha_core.report.each_recording import recording_tables
from eha_core.report.picture import LABELS, Band, Dots, Group, Line, Mark, Panel, Picture
from eha_core.report.series import autocorrelation, pieces, spread
from eha_core.report.stage import Stage, Table, adds_physics, compared_models, judged_spans, model_errors
from eha_core.report.undetected import undetected_tables
from eha_core.report.wording import capital, channel_title

MODELS = ("before", "calibrated", "after")
LAGS = 60


def stage(diagnosis: Diagnosis) -> Stage:
    """The errors of the nominal, recalibrated and augmented models, and whether the residual is noise."""
    kept = "Parts of the recording were held out from the fit, and the models are evaluated on them."
    fitted = "The models are evaluated on the data that they were fitted to."
    sentences = (kept if diagnosis.held_out else fitted, improvement(diagnosis), *_of_sizes(diagnosis))
    return Stage(
        "show",
        "Show",
        residual_headline(diagnosis),
        sentences,
        (_overlays(diagnosis), _whiteness(diagnosis), *_over_input(diagnosis)),
        (
            error_table(diagnosis), *recording_tables(diagnosis), *prediction_table(diagnosis),
            *undetected_tables(diagnosis),
        ),
    )  # fmt: skip


def _of_sizes(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The assumptions behind the tables of smallest sizes."""
    if diagnosis.undetected is None:
        return ()
    return (
        "An effect that was not named is absent or smaller than in the last tables. These assume one further effect at"
        " a time, the fitted model and noise, and the search's quadratic model of this recording.",
    )


def error_table(diagnosis: Diagnosis) -> Table:
    """RMSE of each channel and model on held-out data, and the noise, in a unit that suits the noise."""
    rows = []
    for name, fit in judged(diagnosis).items():
        scale = scale_for(CHANNEL_KINDS[name].unit, fit.noise)
        cells = [f"{short(value / scale.factor)}{scale.suffix}" for value in (*model_errors(diagnosis, fit), fit.noise)]
        rows.append((channel_title(name), *cells, short(fit.rmse_after / fit.noise)))
    title = "RMSE on held-out data" if diagnosis.held_out else "RMSE"
    models = compared_models(diagnosis)
    return Table(("channel", *models, "noise", f"{models[-1]} / noise"), tuple(rows), title)


def prediction_table(diagnosis: Diagnosis) -> tuple[Table, ...]:
    """RMSE of the final model without fitted states: predicted ahead from measured states, and free-running."""
    if not diagnosis.prediction:
        return ()
    ahead = list(next(iter(diagnosis.prediction.values())).ahead)
    rows = []
    for name, prediction in diagnosis.prediction.items():
        unit = CHANNEL_KINDS[name].unit
        errors = [*(prediction.ahead[seconds] for seconds in ahead), prediction.free_running]
        rows.append((channel_title(name), *(quantity(error, unit) for error in errors)))
    headings = ("channel", *(f"{quantity(seconds, 's')} ahead" for seconds in ahead), "free run, the whole record")
    return (Table(headings, tuple(rows), "Prediction from measured states: RMSE of the augmented model"),)


def _overlays(diagnosis: Diagnosis) -> Picture:
    groups: list[Group] = []
    for name in diagnosis.pictures.after:
        groups += [_whole(diagnosis, name), _close_up(diagnosis, name)]
    caption = (
        "The held-out intervals with the residual below, and next to them the one where the recalibrated model is"
        " worst. The lines are the final models; the table has the errors of models refitted without these intervals."
    )
    return Picture("6-show", tuple(groups), (3, 2), "Measured and modelled", caption)


def _models(diagnosis: Diagnosis, name: str) -> list[tuple[str, Array]]:
    """The models of a channel by role; without added physics the recalibrated model is the final one."""
    models = [(role, getattr(diagnosis.pictures, role)) for role in MODELS]
    if not adds_physics(diagnosis):
        del models[MODELS.index("after")]
    return [(role, modelled[name]) for role, modelled in models if name in modelled]


def _scale(diagnosis: Diagnosis, name: str) -> Scale:
    return scale_for(CHANNEL_KINDS[name].unit, float(np.abs(diagnosis.pictures.measured[name]).max()))


def _whole(diagnosis: Diagnosis, name: str) -> Group:
    spans, scale = judged_spans(diagnosis), _scale(diagnosis, name)
    time, measured = diagnosis.pictures.time[name], diagnosis.pictures.measured[name]
    noise = judged(diagnosis)[name].noise
    largest = max(float(np.abs(measured - modelled).max()) for _, modelled in _models(diagnosis, name))
    fine = scale_for(CHANNEL_KINDS[name].unit, largest)
    values: list[Mark] = [_line(time, measured, "measured", spans, scale.factor)]
    left: list[Mark] = [Band(-2.0 * noise / fine.factor, 2.0 * noise / fine.factor, "noise (2 standard deviations)")]
    for role, modelled in _models(diagnosis, name):
        values.append(_line(time, modelled, role, spans, scale.factor))
        left.append(_line(time, measured - modelled, role, spans, fine.factor))
    title = capital(channel_title(name))
    return Group(
        (
            Panel(tuple(values), "time [s]", scale.unit, title, 170),
            Panel(tuple(left), "time [s]", fine.unit, f"{title}: residual", 190),
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
            Group((Panel(tuple(marks), "lag [ms]", "", capital(channel_title(name)), 220, y_range=(-0.4, 1.05)),))
        )
    return Picture(
        "6-show-whiteness",
        tuple(groups),
        (1,) * min(3, max(1, len(groups))),
        "Is the residual white?",
        "Autocorrelation of the residual. White noise stays within the band.",
    )


def _over_input(diagnosis: Diagnosis) -> tuple[Picture, ...]:
    """Each channel's residual over the voltage at the same time; empty where no voltage was recorded."""
    pictures, groups = diagnosis.pictures, []
    if "voltage_command" not in pictures.measured:
        return ()
    at, volts = pictures.time["voltage_command"], pictures.measured["voltage_command"]
    across = scale_for("V", float(np.abs(volts).max()))
    for name in pictures.after:
        time, noise = pictures.time[name], judged(diagnosis)[name].noise
        held = volts[np.clip(np.searchsorted(at, time, side="right") - 1, 0, None)] / across.factor
        residuals = [(role, pictures.measured[name] - modelled) for role, modelled in _models(diagnosis, name)[1:]]
        up = scale_for(CHANNEL_KINDS[name].unit, max(float(np.abs(residual).max()) for _, residual in residuals))
        marks: list[Mark] = [Band(-2.0 * noise / up.factor, 2.0 * noise / up.factor, "noise (2 standard deviations)")]
        for role, residual in residuals:
            x, y = spread(held, residual / up.factor)
            marks.append(Dots(x, y, role, LABELS[role]))
        title = capital(channel_title(name))
        groups.append(Group((Panel(tuple(marks), f"voltage [{across.unit}]", up.unit, title, 220),)))
    columns = (1,) * min(3, max(1, len(groups)))
    caption = "Measured minus modelled over the voltage: a residual that depends on the input is not noise."
    return (Picture("6-show-input", tuple(groups), columns, "Does the residual depend on the input?", caption),)
