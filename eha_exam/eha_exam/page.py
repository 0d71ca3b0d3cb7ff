"""The scored exam as one page that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files

from eha_exam.scoring import OUTCOMES, Mark, Proportion
from eha_exam.shares import Row, Summary, Target
from eha_exam.tables import HEAD
from eha_exam.tiers import MEANINGS

RIGHT, WRONG, PALE = (29, 122, 140), (196, 85, 59), (233, 238, 241)
"""Red, green and blue of the ends and the middle of a share; the ends are those of counts on and off a matrix's
diagonal, too."""

LEGIBLE = 0.55
"""Strength of a colour from which white text is easier to read on it than dark."""

JUDGED = (
    "Met: yes or no where the whole 95 % interval (Wilson) of what was reached says so; open where the aim lies in it."
)
LINKED = "A linked name leads to the case's report; --lost N writes the reports of the first N of these cases."
MATRIX = (
    "Row: what was concealed. Column: what was named. On the diagonal, effects that were named rightly; elsewhere, a"
    " name that was not there for each effect that was missed."
)
NOTHING = "nothing"


def as_html(
    summaries: Sequence[Summary],
    marks: Mapping[str, Sequence[Mark]],
    about: Mapping[str, object],
    reports: Mapping[str, str],
) -> str:
    """The page.

    Args:
        summaries: the score of each tool, the own one first.
        marks: the mark of each case, by tool.
        about: what was run, as named values.
        reports: pages that show a case's diagnosis by the own tool, by the case's name.
    """
    style = (files("eha_exam") / "page.css").read_text(encoding="utf-8")
    items = "".join(f"<li>{escape(name)}: {escape(str(value))}</li>" for name, value in about.items())
    key = "".join(f'<li><i class="{outcome}"></i>{outcome}</li>' for outcome in OUTCOMES)
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1"><title>The exam</title>',
        f"<style>{style}</style></head><body><h1>The exam</h1>",
        f'<ul class="about">{items}</ul><ul class="key">{key}</ul>',
    ]
    for place, summary in enumerate(summaries):
        parts += _tool(summary, marks.get(summary.tool, ()), reports if place == 0 else {})
    tiers = (_cells((tier, meaning)) for tier, meaning in MEANINGS.items())
    parts += ["<h2>Tiers</h2>", _table(("tier", "cases"), tiers), "</body></html>"]
    return "\n".join(parts)


def _tool(summary: Summary, marks: Sequence[Mark], reports: Mapping[str, str]) -> list[str]:
    """Everything about one tool."""
    outcomes = [_outcome(row) for row in summary.rows]
    parts = [
        f"<h2>{escape(summary.tool)}</h2>",
        _table(("group", "", *HEAD), outcomes),
        f"<h3>Targets</h3><p>{JUDGED}</p>",
        _table(("target", "aim", "reached", "met"), map(_target, summary.targets)),
        "<h3>Right, by tier and noise</h3><p>Share of right cases; below it their number and 95 % interval.</p>",
        _by_noise(summary),
    ]
    if summary.confusion or summary.rightly:
        parts += [f"<h3>What was named in place of what</h3><p>{MATRIX}</p>", _matrix(summary)]
    if marks:
        count = sum(mark.outcome in ("wrong", "failed") for mark in marks)
        parts.append(f"<details{' open' if count else ''}><summary>Wrong or failed cases ({count})</summary>")
        parts.append(f"<p>{LINKED}</p>")
        parts.append(_cases([mark for mark in marks if mark.outcome in ("wrong", "failed")], reports) + "</details>")
        parts.append(f"<details><summary>All cases ({len(marks)})</summary>{_cases(marks, reports)}</details>")
    return parts


def _outcome(row: Row) -> str:
    """A group of cases: a bar of its outcomes, each share with its interval, and the seconds that a case took."""
    shares = (row.right, row.abstained, row.wrong, row.failed)
    cells = "".join(f"<td>{_told(share)}</td>" for share in (*shares, row.site_right))
    seconds = _cells((f"{row.median_seconds:.1f}", f"{row.longest_seconds:.1f}"))
    return f"<td>{escape(row.group)}</td><td>{_bar(shares)}</td><td>{row.cases}</td>{cells}{seconds}"


def _told(share: Proportion) -> str:
    """A share in per cent, below it the cases and its interval."""
    if share.value is None:
        return "-"
    low, high = (100.0 * end for end in share.interval)
    return f"{100.0 * share.value:.0f} %<small>{share.successes}/{share.trials}, {low:.0f} to {high:.0f} %</small>"


def _target(target: Target) -> str:
    cells = _cells((target.statement.replace("`", ""), target.aim, target.reached))
    return f'{cells}<td class="{target.judged.replace(" ", "-")}">{escape(target.judged)}</td>'


def _by_noise(summary: Summary) -> str:
    noises = sorted({noise for _, noise, _ in summary.by_noise})
    found = {(tier, noise): share for tier, noise, share in summary.by_noise}
    rows = [
        f"<td>{escape(tier)}</td>" + "".join(_share(found.get((tier, noise))) for noise in noises)
        for tier in MEANINGS
        if any((tier, noise) in found for noise in noises)
    ]
    return _table(("tier", *(f"noise {noise:g}x" for noise in noises)), rows, "shares")


def _share(share: Proportion | None) -> str:
    """A share as a cell between two colours, with its interval."""
    if share is None or share.value is None:
        return "<td></td>"
    return f'<td style="{_colour(share.value)}">{_told(share)}</td>'


def _colour(share: float) -> str:
    """From WRONG at 0 over pale at one half to RIGHT at 1."""
    strength = abs(2.0 * share - 1.0)
    end = RIGHT if share > 0.5 else WRONG
    red, green, blue = (round(pale + strength * (full - pale)) for pale, full in zip(PALE, end, strict=True))
    return f"background:rgb({red},{green},{blue});color:{'#fff' if strength > LEGIBLE else 'inherit'}"


def _matrix(summary: Summary) -> str:
    """Concealed effects over named ones, each count a colour."""
    counts = {(concealed, other): count for concealed, other, count in summary.confusion}
    counts |= {(name, name): count for name, count in summary.rightly}
    rows = _ordered({concealed for concealed, _ in counts})
    columns = _ordered({other for _, other in counts})
    head = "".join(f"<th><span>{escape(name.replace('_', ' '))}</span></th>" for name in columns)
    most = max(counts.values())
    body = []
    for concealed in rows:
        cells = (_count(counts.get((concealed, other), 0), most, concealed == other) for other in columns)
        body.append(f"<tr><th>{escape(concealed.replace('_', ' '))}</th>{''.join(cells)}</tr>")
    table = f"<thead><tr><th>concealed \\ named</th>{head}</tr></thead><tbody>{''.join(body)}</tbody>"
    return f'<div class="scroll"><table class="names">{table}</table></div>'


def _ordered(names: set[str]) -> list[str]:
    return [*sorted(names - {NOTHING}), *(names & {NOTHING})]


def _count(count: int, most: int, right: bool) -> str:
    if not count:
        return "<td></td>"
    red, green, blue = RIGHT if right else WRONG
    strength = 0.35 + 0.65 * (count / most) ** 0.5
    ink = "#fff" if strength > LEGIBLE else "inherit"
    return f'<td style="background:rgba({red},{green},{blue},{strength:.2f});color:{ink}">{count}</td>'


def _cases(marks: Sequence[Mark], reports: Mapping[str, str]) -> str:
    rows = []
    for mark in marks:
        link = reports.get(mark.name)
        name = f'<a href="{escape(link)}">{escape(mark.name)}</a>' if link else escape(mark.name)
        concealed, named = " + ".join(mark.concealed) or NOTHING, " + ".join(mark.named) or "-"
        cells = _cells((f"{mark.noise:g}x", concealed, mark.verdict, named, f"{mark.seconds:.1f}"))
        rows.append(f'<td>{name}</td><td><i class="chip {mark.outcome}"></i>{mark.outcome}</td>{cells}')
    return _table(("case", "outcome", "noise", "concealed", "verdict", "named", "s"), rows, "cases")


def _table(head: Sequence[str], rows: Iterable[str], kind: str = "") -> str:
    """A table of rows of cells, each of which names its column, as a phone shows them below each other."""
    headings = "".join(f"<th>{escape(heading)}</th>" for heading in head)
    body = "".join(f"<tr>{_labelled(row, head)}</tr>" for row in rows)
    table = f"<thead><tr>{headings}</tr></thead><tbody>{body}</tbody>"
    return f'<div class="scroll"><table class="{kind}">{table}</table></div>'


def _labelled(row: str, head: Sequence[str]) -> str:
    before, *cells = row.split("<td")
    labelled = (f'<td data-label="{escape(heading)}"{cell}' for heading, cell in zip(head, cells, strict=True))
    return before + "".join(labelled)


def _cells(cells: Sequence[str]) -> str:
    return "".join(f"<td>{escape(cell)}</td>" for cell in cells)


def _bar(shares: Sequence[Proportion]) -> str:
    """A stacked bar of the shares of each outcome."""
    pieces = (
        f'<i class="{outcome}" style="width:{100.0 * (share.value or 0.0):.1f}%"></i>'
        for outcome, share in zip(OUTCOMES, shares, strict=True)
    )
    return f'<div class="bar" role="img">{"".join(pieces)}</div>'
