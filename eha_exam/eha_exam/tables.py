"""The scored table in Markdown and JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from eha_exam.scoring import Mark
from eha_exam.shares import Summary
from eha_exam.sittings import SCHEMA
from eha_exam.tiers import MEANINGS

HEAD = ("cases", "right", "abstained", "wrong", "failed", "right site", "CPU s, median", "CPU s, longest")


def as_json(summaries: Sequence[Summary], marks: Mapping[str, Sequence[Mark]], about: Mapping[str, object]) -> str:
    """Everything, by tool: rows, targets and the mark of each case."""
    tools = {
        summary.tool: {**asdict(summary), "marks": [asdict(mark) for mark in marks[summary.tool]]}
        for summary in summaries
    }
    return json.dumps({"schema": SCHEMA, "about": dict(about), "tools": tools}, indent=1)


def as_markdown(summaries: Sequence[Summary], about: Mapping[str, object]) -> str:
    """The tables as Markdown: one of outcomes with all tools, then each tool's targets, and wrong or failed cases."""
    lines = ["# The exam's table", "", *(f"- {name}: {value}" for name, value in about.items()), ""]
    lines += _markdown_table(("group", "tool", *HEAD), outcome_rows(summaries))
    for summary in summaries:
        lines += ["", f"## {summary.tool}: targets", ""]
        rows = [[target.statement, target.aim, target.reached, target.judged] for target in summary.targets]
        lines += _markdown_table(("target", "aim", "reached", "met"), rows)
        lines += ["", f"## {summary.tool}: what was named in place of what", ""]
        lines += _markdown_table(("concealed", "named", "times"), _confusion(summary))
        lines += ["", f"## {summary.tool}: how probable names were said to be, and how often they were true", ""]
        lines += _markdown_table(("stated, %", "mean stated, %", "true"), _reliability(summary))
        if summary.lost:
            lines += ["", f"## {summary.tool}: wrong or failed cases", ""]
            lines += _markdown_table(("case", "noise", "concealed", "verdict", "named"), _lost(summary))
    lines += ["", "## Tiers", "", *(f"- `{tier}`: {meaning}" for tier, meaning in MEANINGS.items()), ""]
    return "\n".join(lines)


def outcome_rows(summaries: Sequence[Summary]) -> list[list[str]]:
    """A row for each group and tool: group, tool, and what stands under HEAD."""
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


def _reliability(summary: Summary) -> list[list[str]]:
    return [
        [f"{100 * one.low:g} to {100 * one.high:g}", f"{100 * one.stated:.1f}", str(one.observed)]
        for one in summary.reliability
    ]


def _lost(summary: Summary) -> list[list[str]]:
    return [
        [
            mark.name,
            f"{mark.noise:g}x",
            " + ".join(mark.concealed) or "nothing",
            mark.verdict,
            " + ".join(mark.named) or "-",
        ]
        for mark in summary.lost
    ]


def _markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows)]
