"""The scored table in Markdown, JSON and HTML: three presenters of the same summaries."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from html import escape

from eha_core.exam.scoring import Mark, Proportion
from eha_core.exam.shipped import Shown
from eha_core.exam.summary import Summary
from eha_core.exam.tiers import MEANINGS

HEAD = ("cases", "right", "abstained", "wrong", "failed", "right site", "s, median", "s, longest")
SHOWN = ("recording", "source", "concealed", "verdict", "named", "right", "s", "note")


def as_json(
    summaries: Sequence[Summary],
    marks: Mapping[str, Sequence[Mark]],
    about: Mapping[str, object],
    shown: Sequence[Shown] = (),
) -> str:
    """Everything, by tool: rows, targets and the mark of each case."""
    tools = {s.tool: {**asdict(s), "marks": [asdict(m) for m in marks[s.tool]]} for s in summaries}
    return json.dumps(
        {"schema": "eha.exam/1", "about": dict(about), "tools": tools, "others": [asdict(s) for s in shown]}, indent=1
    )


def as_markdown(summaries: Sequence[Summary], about: Mapping[str, object], shown: Sequence[Shown] = ()) -> str:
    """The tables as Markdown: one of outcomes with all tools, then each tool's targets and lost cases."""
    lines = ["# The exam's table", "", *(f"- {name}: {value}" for name, value in about.items()), ""]
    lines += _markdown_table(("group", "tool", *HEAD), _rows(summaries))
    for summary in summaries:
        lines += ["", f"## {summary.tool}: targets", ""]
        rows = [[t.statement, t.aim, t.reached, _met(t.met)] for t in summary.targets]
        lines += _markdown_table(("target", "aim", "reached", "met"), rows)
        lines += ["", f"## {summary.tool}: what was named in place of what", ""]
        lines += _markdown_table(("concealed", "named", "times"), _confusion(summary))
        if summary.lost:
            lines += ["", f"## {summary.tool}: lost cases", ""]
            lines += _markdown_table(("case", "noise", "concealed", "verdict", "named"), _lost(summary))
    if shown:
        lines += ["", "## Recordings that the exam did not make", ""]
        lines += _markdown_table(SHOWN, _shown(shown))
    lines += ["", "## Tiers", "", *(f"- `{tier}`: {meaning}" for tier, meaning in MEANINGS.items()), ""]
    return "\n".join(lines)


def as_html(
    summaries: Sequence[Summary],
    about: Mapping[str, object],
    reports: Mapping[str, str],
    shown: Sequence[Shown] = (),
) -> str:
    """One self-contained page; `reports` maps a lost case's name to the page that shows its diagnosis."""
    parts = [_STYLE, "<h1>The exam</h1><ul>"]
    parts += [f"<li>{escape(name)}: {escape(str(value))}</li>" for name, value in about.items()]
    parts.append("</ul><p>Bars: right, abstained, wrong, failed.</p>")
    for summary in summaries:
        parts.append(f"<h2>{escape(summary.tool)}</h2><table><tr><th>group</th><th></th>")
        parts += [f"<th>{escape(head)}</th>" for head in HEAD] + ["</tr>"]
        for row, cells in zip(summary.rows, _rows([summary]), strict=True):
            bar = _bar((row.right, row.abstained, row.wrong, row.failed))
            parts.append(f"<tr><td>{escape(cells[0])}</td><td>{bar}</td>" + _cells(cells[2:]) + "</tr>")
        parts.append("</table><h3>Targets</h3><table><tr><th>target</th><th>aim</th><th>reached</th><th>met</th></tr>")
        parts += [f"<tr>{_cells((t.statement, t.aim, t.reached, _met(t.met)))}</tr>" for t in summary.targets]
        parts.append("</table><h3>What was named in place of what</h3><table>")
        parts.append("<tr><th>concealed</th><th>named</th><th>times</th></tr>")
        parts += [f"<tr>{_cells(cells)}</tr>" for cells in _confusion(summary)] + ["</table>"]
        if summary.lost:
            parts.append("<h3>Lost cases</h3><table><tr><th>case</th><th>noise</th><th>concealed</th><th>verdict</th>")
            parts.append("<th>named</th></tr>")
            for cells in _lost(summary):
                link = reports.get(cells[0])
                name = f'<a href="{escape(link)}">{escape(cells[0])}</a>' if link else escape(cells[0])
                parts.append(f"<tr><td>{name}</td>{_cells(cells[1:])}</tr>")
            parts.append("</table>")
    if shown:
        parts.append("<h2>Recordings that the exam did not make</h2><table><tr>")
        parts += [f"<th>{escape(head)}</th>" for head in SHOWN] + ["</tr>"]
        parts += [f"<tr>{_cells(cells)}</tr>" for cells in _shown(shown)] + ["</table>"]
    return "\n".join(parts)


def _shown(shown: Sequence[Shown]) -> list[list[str]]:
    return [
        [
            one.recording,
            one.source,
            " + ".join(one.expected) or "nothing",
            one.verdict,
            " + ".join(one.named) or "-",
            "yes" if one.right else "no",
            f"{one.seconds:.1f}",
            one.note,
        ]
        for one in shown
    ]


def _rows(summaries: Sequence[Summary]) -> list[list[str]]:
    groups = {row.group: None for summary in summaries for row in summary.rows}
    lines = []
    for group in groups:
        for summary in summaries:
            for row in (row for row in summary.rows if row.group == group):
                shares = [str(p) for p in (row.right, row.abstained, row.wrong, row.failed, row.site_right)]
                times = [f"{row.median_seconds:.1f}", f"{row.longest_seconds:.1f}"]
                lines.append([group, summary.tool, str(row.cases), *shares, *times])
    return lines


def _confusion(summary: Summary) -> list[list[str]]:
    return [[concealed, named, str(times)] for concealed, named, times in summary.confusion]


def _lost(summary: Summary) -> list[list[str]]:
    return [
        [m.name, f"{m.noise:g}x", " + ".join(m.concealed) or "nothing", m.verdict, " + ".join(m.named) or "-"]
        for m in summary.lost
    ]


def _markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows)]


def _met(met: bool | None) -> str:
    return "no case" if met is None else "yes" if met else "no"


def _cells(cells: Sequence[str]) -> str:
    return "".join(f"<td>{escape(cell)}</td>" for cell in cells)


def _bar(shares: Sequence[Proportion]) -> str:
    """A stacked bar of four shares as an inline drawing."""
    x, pieces = 0.0, []
    for colour, share in zip(("#2a7", "#bbb", "#c33", "#111"), shares, strict=True):
        width = 160.0 * (share.value or 0.0)
        pieces.append(f'<rect x="{x:.1f}" width="{width:.1f}" height="12" fill="{colour}"/>')
        x += width
    return f'<svg width="160" height="12" role="img">{"".join(pieces)}</svg>'


_STYLE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>The exam</title><style>
body{font:15px/1.45 system-ui,sans-serif;max-width:80rem;margin:2rem auto;padding:0 1rem;color:#222}
table{border-collapse:collapse;font-size:13px}td,th{padding:.2rem .6rem;border-bottom:1px solid #ddd;text-align:left}
</style>"""
