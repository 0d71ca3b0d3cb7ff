"""A stage of the report, its parts and tables, and what the stages share."""

from __future__ import annotations

from dataclasses import dataclass

from eha_core.diagnosis.result import ChannelFit, Diagnosis
from eha_core.report.picture import Picture, Spans

MOST_OF_IT = 0.9

SURE = 1.96
"""Standard deviations to either side that make a 95 % interval."""


@dataclass(frozen=True)
class Table:
    """Rows of text under headings; the first column names the row."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str


@dataclass(frozen=True)
class Part:
    """One of several findings of a stage, with its picture."""

    title: str
    sentences: tuple[str, ...]
    pictures: tuple[Picture, ...] = ()
    code: str = ""


@dataclass(frozen=True)
class Stage:
    """A stage: its name, the finding as a headline, a few sentences, and pictures, tables, code and parts."""

    name: str
    title: str
    headline: str
    sentences: tuple[str, ...]
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()
    code: str = ""
    parts: tuple[Part, ...] = ()


def adds_physics(diagnosis: Diagnosis) -> bool:
    """Whether the final model has more than the nominal equations."""
    return bool(diagnosis.effects or diagnosis.unknown)


def compared_models(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The models with errors of their own: without added physics the recalibrated model is the final one."""
    return ("nominal", "recalibrated", "augmented")[: 3 if adds_physics(diagnosis) else 2]


def model_errors(diagnosis: Diagnosis, fit: ChannelFit) -> tuple[float, ...]:
    """The RMSE of each of `compared_models` in a channel."""
    return (fit.rmse_before, fit.rmse_calibrated, fit.rmse_after)[: len(compared_models(diagnosis))]


def judged_spans(diagnosis: Diagnosis) -> tuple[tuple[float, float], ...]:
    """The held-out spans; the whole record where none was held out."""
    return diagnosis.pictures.held_out or (diagnosis.drawn,)


def violated(diagnosis: Diagnosis) -> tuple[Spans, ...]:
    """The intervals of the first location, unless they cover nearly the whole record."""
    when = diagnosis.location[0].when if diagnosis.location else ()
    covered = sum(end - start for start, end in when)
    begin, end = diagnosis.drawn
    if not when or covered > MOST_OF_IT * (end - begin):
        return ()
    return (Spans(when, "where the model departs"),)
