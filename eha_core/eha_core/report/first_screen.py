"""The pictures of the first screen: the laws, each model's residual, the evidence, and residuals over time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.identification.numbers import Array
from eha_core.quantities import quantity, scale_for
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import judged
from eha_core.report.contribution import ladder_picture
from eha_core.report.health import Intervals, drawn_line, excluded, shaded
from eha_core.report.laws import Law, laws
from eha_core.report.picture import LABELS, Band, Dots, Group, Line, Mark, Panel, Picture, Ribbon
from eha_core.report.rivals_picture import evidence_picture
from eha_core.report.series import spread
from eha_core.report.stage import adds_physics
from eha_core.report.wording import capital, channel_title

RIVALS = 5
"""Hypotheses that the first screen compares; stage 4 has more."""

ABREAST = 3
"""Panels beside each other."""

MEASURED, FITTED, SURE_BAND = "measured channels, weak form", "fitted law", "95 % of the fitted law"

DOTS = 700
"""Most points of one law."""

SURROUND = 0.12
"""Share of a law's height that is shown above and below it; points at a reversal lie far outside."""


def pictures(diagnosis: Diagnosis, found: Mapping[str, Law] | None = None) -> tuple[Picture, ...]:
    """The laws (`found`, if given), each model's residual, the evidence, and the residuals over time; the last come
    first where a part of the recording was excluded."""
    rivals = bool(diagnosis.rivals)
    title = "How far other explanations are behind"
    shown: tuple[Picture | None, ...] = (
        law_picture(diagnosis, found),
        ladder_picture(diagnosis),
        evidence_picture(diagnosis, RIVALS, "0-evidence", title) if rivals else None,
        residual_picture(diagnosis),
    )
    if any(excluded(diagnosis, name) for name in diagnosis.pictures.after):
        shown = (shown[-1], *shown[:-1])
    return tuple(picture for picture in shown if picture)


def law_picture(diagnosis: Diagnosis, found: Mapping[str, Law] | None = None) -> Picture | None:
    """Each missing effect as a law in SI; None where it has none."""
    found = laws(diagnosis) if found is None else found
    if not found:
        return None
    columns = (1,) * min(ABREAST, len(found))
    caption = (
        "Solid: the law as fitted, with the 95 % band of its parameters (which may be narrower than the line). Dashed:"
        " the nominal model."
    )
    if any(len(law.points_x) for law in found.values()):
        caption += (
            " Points: the law computed from the measured channels by its equation, without simulation; for a force,"
            " only where the piston neither stops nor reverses."
        )
    return Picture(
        "0-laws", tuple(Group((law_panel(law),)) for law in found.values()), columns, "The missing physics", caption
    )


def law_panel(law: Law, height: int = 250) -> Panel:
    """The law with its band and points, and the nominal model's law."""
    across = scale_for(law.across.unit, float(np.abs(law.x).max(initial=0.0)))
    # two axes with the same unit have the same scale, so that a slope of one looks like one
    same = law.up.unit == law.across.unit
    up = across if same else scale_for(law.up.unit, float(np.abs(law.y).max(initial=0.0)))
    x, marks = law.x / across.factor, list[Mark]()
    if len(law.nominal):
        marks.append(Line(x, law.nominal / up.factor, "before", LABELS["before"], 2.0, dashed=True))
    if np.any(law.high > law.low):
        marks.append(Ribbon(x, law.low / up.factor, law.high / up.factor, "after", SURE_BAND))
    marks.append(Line(x, law.y / up.factor, "after", FITTED, 2.2))
    if len(law.points_x):
        points_x, points_y = spread(law.points_x / across.factor, law.points_y / up.factor, most=DOTS)
        marks.append(Dots(points_x, points_y, "measured", MEASURED, 4.0))
    everything = np.concatenate([law.low, law.high, law.nominal]) / up.factor
    low, high = float(everything.min()), float(everything.max())
    room = SURROUND * (high - low or abs(high) or 1.0)
    return Panel(
        tuple(marks),
        f"{law.across.title} [{across.unit or '-'}]",
        f"{law.up.title} [{up.unit or '-'}]",
        law.title,
        height,
        y_range=(low - room, high + room),
    )


def residual_picture(diagnosis: Diagnosis) -> Picture:
    """Each channel's residual over time, of the nominal model and of the final one, each on its own scale."""
    names = list(diagnosis.pictures.after)[:ABREAST]
    groups = tuple(_residuals(diagnosis, name) for name in names)
    caption = (
        "The upper and lower plots each have a scale of their own. Both models start from fitted states in each window"
        " of the fit. Grey: two standard deviations of the noise."
    )
    if any(excluded(diagnosis, name) for name in names):
        caption += " Shaded: excluded, because the recording has a gap or a fault there."
    columns = (1,) * max(1, len(names))
    title = "Residuals, measured minus modelled: nominal model and final model"
    return Picture("0-residuals", groups, columns, title, caption)


def _residuals(diagnosis: Diagnosis, name: str) -> Group:
    pictures, fit = diagnosis.pictures, judged(diagnosis)[name]
    unit, time = CHANNEL_KINDS[name].unit, diagnosis.pictures.time[name]
    last = "after" if adds_physics(diagnosis) else "calibrated"
    title = capital(channel_title(name))
    above = f"{title}: {quantity(fit.rmse_before, unit)} RMS"
    below = f"{quantity(fit.rmse_after, unit)} RMS, noise {quantity(fit.noise, unit)}"
    models = ((pictures.before, "before", above), (getattr(pictures, last), last, below))
    spans = excluded(diagnosis, name)
    return Group(
        tuple(
            _residual(time, pictures.measured[name] - model[name], role, unit, fit.noise, text, spans)
            for model, role, text in models
        )
    )


def _residual(time: Array, residual: Array, role: str, unit: str, noise: float, title: str, spans: Intervals) -> Panel:
    scale = scale_for(unit, float(np.abs(residual).max()))
    x, y = drawn_line(time, residual / scale.factor, spans, 1500)
    band = Band(-2.0 * noise / scale.factor, 2.0 * noise / scale.factor, "noise (2 standard deviations)")
    return Panel((band, *shaded(spans), Line(x, y, role, LABELS[role], 1.0)), "time [s]", scale.unit, title, 84)
