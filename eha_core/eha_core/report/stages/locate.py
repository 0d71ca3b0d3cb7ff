"""Stage 3, locate: which equation is violated, where in state space, and when."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.effects import SITES
from eha_core.identification.numbers import Array
from eha_core.quantities import quantity, scale_for
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import equations_hold, judged
from eha_core.report.location import location_statement
from eha_core.report.picture import Band, Dots, Group, Line, Mark, Panel, Picture
from eha_core.report.series import spread, strongest_dependence, thinned
from eha_core.report.stage import Stage, Table, violated
from eha_core.report.wording import (
    EQUATION_TITLES,
    VARIABLE_UNITS,
    capital,
    channel_title,
    listed,
    percent,
    span,
    variable_title,
    words,
)

NOISE = Band(-2.0, 2.0, "noise alone (2 standard deviations)")
MENTIONED_SHARE = 0.1
"""Share of the unexplained error; another site that could explain less is only in the table."""

SIGNIFICANT_SHARE = 0.03
"""Share of the variance; a dependence that explains less is not reported."""


def stage(diagnosis: Diagnosis) -> Stage:
    """The residual after calibration, by equation and by channel, over time and over the variable that it depends on
    most."""
    if not diagnosis.location:
        holds = equations_hold(diagnosis)
        headline = "No equation is violated" if holds else "No mismatch remains that an effect would explain"
        sentences = ["The residual of calibration is examined for structure, in time and over every state."]
    else:
        headline = capital(location_statement(diagnosis.location[0]))
        sentences = ["This is the mismatch that no choice of the nominal parameters removes."]
        sentences.append(_others(diagnosis))
        when = diagnosis.location[0].when
        if 1 < len(when) <= 6:
            sentences.append(f"It is largest from {listed([span(interval) for interval in when])}.")
    pictures = (
        _picture("3-locate", "Each equation, evaluated with the measured channels", diagnosis, _equations(diagnosis)),
        _picture("3-locate-channels", "Each channel minus the recalibrated model", diagnosis, _channels(diagnosis)),
    )
    return Stage(
        "locate",
        "Locate",
        headline,
        tuple(sentences),
        tuple(picture for picture in pictures if picture.groups),
        _tables(diagnosis),
    )


def _others(diagnosis: Diagnosis) -> str:
    """The shares that effects at other sites could explain: the sites overlap, so the shares do not add up to one."""
    weighty = [location for location in diagnosis.location[1:] if location.share > MENTIONED_SHARE]
    others = [f"{SITES[location.site].words} ({percent(location.share)})" for location in weighty]
    if not others:
        return ""
    return f"Sites overlap in what they could explain: an effect {listed(others)} would also reduce the error."


def _equations(diagnosis: Diagnosis) -> Iterator[tuple[str, Array, Array]]:
    for name, (time, residual) in diagnosis.pictures.equations.items():
        yield EQUATION_TITLES.get(name, words(name)), time, residual


def _channels(diagnosis: Diagnosis) -> Iterator[tuple[str, Array, Array]]:
    pictures, fits = diagnosis.pictures, judged(diagnosis)
    for name, modelled in pictures.calibrated.items():
        noise = quantity(fits[name].noise, CHANNEL_KINDS[name].unit)
        yield (
            f"{capital(channel_title(name))} (noise {noise})",
            pictures.time[name],
            (pictures.measured[name] - modelled) / fits[name].noise,
        )


def _picture(name: str, title: str, diagnosis: Diagnosis, rows: Iterator[tuple[str, Array, Array]]) -> Picture:
    groups: list[Group] = []
    for row_title, time, residual in rows:
        x, y = thinned(time, residual)
        marks: tuple[Mark, ...] = (*violated(diagnosis), NOISE, Line(x, y, "calibrated", "mismatch", 1.1))
        groups.append(Group((Panel(marks, "time [s]", "in units of noise", row_title, 210),)))
        groups.append(Group((_against(diagnosis, time, residual, row_title),)))
    right = (
        "over the variable that explains most of its variance, with that share; the dark line is the mean"
        if diagnosis.pictures.variables
        else "how often each value occurs"
    )
    caption = f"Each over time, and next to it {right}."
    return Picture(name, tuple(groups), (3, 2), title, caption)


def _against(diagnosis: Diagnosis, time: Array, residual: Array, title: str) -> Panel:
    dependence = strongest_dependence(time, residual, diagnosis.pictures.variables)
    if dependence is None:
        counts, edges = np.histogram(residual, 60, density=True)
        centres = 0.5 * (edges[1:] + edges[:-1])
        return Panel(
            (Line(centres, counts, "calibrated"),), "in units of noise", "density", f"{title}: distribution", 210
        )
    scale = scale_for(VARIABLE_UNITS[dependence.variable], float(np.abs(dependence.at).max()))
    x, y = spread(dependence.at / scale.factor, residual)
    marks = (
        NOISE,
        Dots(x, y, "calibrated", "mismatch"),
        Line(dependence.centres / scale.factor, dependence.means, "measured", "mean", 2.0),
    )
    name = variable_title(dependence.variable)
    label = f"{name} [{scale.unit}]"
    explained = f"{percent(dependence.share)} explained"
    return Panel(marks, label, "", explained if dependence.share > SIGNIFICANT_SHARE else "No dependence found", 210)


def _tables(diagnosis: Diagnosis) -> tuple[Table, ...]:
    rows = tuple(
        (location.site, percent(location.share), location.where, _times(location.when))
        for location in diagnosis.location
    )
    return (Table(("site", "could explain", "where", "when"), rows, "Locations"),) if rows else ()


def _times(when: tuple[tuple[float, float], ...]) -> str:
    shown = ", ".join(f"{start:.1f} to {end:.1f} s" for start, end in when[:5])
    return shown + (f" and {len(when) - 5} more" if len(when) > 5 else "")
