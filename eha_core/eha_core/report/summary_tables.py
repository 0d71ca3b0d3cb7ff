"""The summary of a diagnosis in aligned tables, as text and as HTML."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from math import isfinite
from pathlib import Path
from textwrap import wrap

from eha_core.diagnosis.result import Diagnosis
from eha_core.quantities import scale_for, short
from eha_core.recording import CHANNEL_KINDS
from eha_core.report.claims import judged
from eha_core.report.finding import identified_parameters
from eha_core.report.health import fault_lines
from eha_core.report.stage import SURE, Table, compared_models, model_errors
from eha_core.report.undetected import not_missing
from eha_core.report.wording import VERDICT_TITLES, channel_title, channels_listed, plain, sentence

WIDTH = 96
DIGITS = 5


@dataclass(frozen=True)
class Summary:
    """Facts, tables and notes under one title; `str` gives text, a notebook shows HTML."""

    title: str
    facts: tuple[tuple[str, str], ...]
    tables: tuple[Table, ...]
    notes: tuple[str, ...]

    def __str__(self) -> str:
        double, single = "=" * WIDTH, "-" * WIDTH
        lines = [self.title.center(WIDTH).rstrip(), double]
        for name, text in self.facts:
            first, *rest = wrap(text, WIDTH - 14) or [""]
            lines += [f"{name + ':':14}{first}", *(" " * 14 + line for line in rest)]
        for table in self.tables:
            lines += [double, *_columns(table, single)]
        lines.append(double)
        for note in self.notes:
            lines += wrap(note, WIDTH, subsequent_indent="  ")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        facts = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in self.facts)
        tables = "".join(_html(table) for table in self.tables)
        notes = "".join(f"<p>{escape(note)}</p>" for note in self.notes)
        left = "text-align:left"
        return (
            f"<div><h4>{escape(self.title)}</h4>"
            f'<table style="{left}">{facts.replace("<td>", f"""<td style="{left}">""")}</table>{tables}{notes}</div>'
        )


def summarise(diagnosis: Diagnosis) -> Summary:
    """The summary of a diagnosis."""
    name, channels = Path(diagnosis.path).name, channels_listed(diagnosis.channels)
    facts = (
        ("Recording", f"{name}, {diagnosis.duration:.1f} s: {channels}"),
        *(("Health", sentence(plain(fault))) for fault in fault_lines(diagnosis)),
        ("Verdict", VERDICT_TITLES[diagnosis.verdict]),
        ("Finding", diagnosis.summary),
        *(("Not found", text) for text in (not_missing(diagnosis),) if text),
    )
    tables = tuple(table for table in (_effects(diagnosis), _parameters(diagnosis), _errors(diagnosis)) if table.rows)
    return Summary("Diagnosis", facts, tables, tuple(_notes(diagnosis)))


def _effects(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        _row(f"{effect.id}.{name}", fitted.value, fitted.std, fitted.unit)
        for effect in diagnosis.effects
        for name, fitted in identified_parameters(effect).items()
    )
    return Table(("missing physics", "value", "std err", "[0.025", "0.975]", "unit"), rows, "Missing physics")


def _parameters(diagnosis: Diagnosis) -> Table:
    rows = tuple(
        (*_row(parameter.name, parameter.fitted, parameter.std, parameter.unit), _number(parameter.nominal))
        for parameter in diagnosis.parameters
        if parameter.changed
    )
    headings = ("changed parameter", "value", "std err", "[0.025", "0.975]", "unit", "nominal")
    return Table(headings, rows, "Changed parameters")


def _row(name: str, value: float, deviation: float, unit: str) -> tuple[str, ...]:
    if not isfinite(deviation):
        return (name, _number(value), "-", "-", "-", unit)
    low, high = value - SURE * deviation, value + SURE * deviation
    return (name, _number(value), f"{deviation:.2g}", _number(low), _number(high), unit)


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def _errors(diagnosis: Diagnosis) -> Table:
    rows = []
    for name, fit in judged(diagnosis).items():
        scale = scale_for(CHANNEL_KINDS[name].unit, fit.noise)
        values = (*model_errors(diagnosis, fit), fit.noise)
        cells = [short(value / scale.factor) for value in values]
        rows.append((channel_title(name), *cells, scale.unit, short(fit.rmse_after / fit.noise)))
    title = "RMSE on held-out data" if diagnosis.held_out else "RMSE"
    models = compared_models(diagnosis)
    return Table((title, *models, "noise", "unit", f"{models[-1]} / noise"), tuple(rows), title)


def _notes(diagnosis: Diagnosis) -> Iterator[str]:
    for alternative in diagnosis.alternatives:
        rival, behind = " + ".join(alternative.effects), alternative.evidence_gap
        yield f"Cannot be distinguished from {rival} (evidence {behind:.1f} less)."
    if diagnosis.next_experiment:
        yield f"Next experiment: {sentence(diagnosis.next_experiment.statement)}"
    if diagnosis.damaged:
        yield f"Damaged: {diagnosis.damaged}."
    yield from (sentence(plain(f"Not examined: {note}")) for note in diagnosis.not_examined)
    yield from (sentence(plain(remark)) for remark in diagnosis.remarks)


def _columns(table: Table, rule: str) -> list[str]:
    """Rows below their headings: names left-aligned, numbers right-aligned, the first column takes the free width."""
    rows = [table.headings, *table.rows]
    widths = [max(len(row[place]) for row in rows) + 2 for place in range(1, len(table.headings))]
    first = max(WIDTH - sum(widths), max(len(row[0]) for row in rows))
    lines = [
        f"{row[0]:{first}}" + "".join(f"{cell:>{width}}" for cell, width in zip(row[1:], widths, strict=True))
        for row in rows
    ]
    return [lines[0], rule, *lines[1:]]


def _html(table: Table) -> str:
    head = "".join(f"<th>{escape(heading)}</th>" for heading in table.headings)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows)
    return f"<table><tr>{head}</tr>{body}</table>"
