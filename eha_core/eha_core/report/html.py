"""The report as one page that needs nothing else: words, numbers and pictures to zoom into."""

from __future__ import annotations

import json
from collections.abc import Iterable
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template

from plotly.offline import get_plotlyjs

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.picture import Picture
from eha_core.report.plotly_drawing import figure
from eha_core.report.stages import story
from eha_core.report.stages.show import error_table
from eha_core.report.stages.stage import Stage, Table
from eha_core.report.wording import VERDICT_TITLES, sentence


def page(diagnosis: Diagnosis) -> str:
    """The whole page as text."""
    stages = story(diagnosis)
    template = Template((files("eha_core.report") / "page.html").read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(f"Diagnosis of {Path(diagnosis.path).name}"),
        style=(files("eha_core.report") / "page.css").read_text(encoding="utf-8"),
        script=(files("eha_core.report") / "page.js").read_text(encoding="utf-8"),
        plotly=get_plotlyjs(),
        recording=escape(Path(diagnosis.path).name),
        verdict=diagnosis.verdict,
        verdict_title=escape(VERDICT_TITLES[diagnosis.verdict]),
        summary=escape(_summary(diagnosis)),
        errors=_table(error_table(diagnosis), folded=False),
        steps="".join(
            f'<a href="#{one.name}"><span>{number}</span>{escape(one.title)}</a>'
            for number, one in enumerate(stages, start=1)
        ),
        stages="".join(_stage(number, one) for number, one in enumerate(stages, start=1)),
    )


def write_page(diagnosis: Diagnosis, path: Path) -> None:
    """Write the page to `path`."""
    path.write_text(page(diagnosis), encoding="utf-8")


def _summary(diagnosis: Diagnosis) -> str:
    """The summary without the verdict, which stands above it."""
    return sentence(diagnosis.summary.removeprefix(f"{VERDICT_TITLES[diagnosis.verdict]}: "))


def _stage(number: int, stage: Stage) -> str:
    code = f"<pre>{escape(stage.code)}</pre>" if stage.code else ""
    return (
        f'<section id="{stage.name}"><p class="step"><span>{number}</span>{escape(stage.title)}</p>'
        f"<h2>{escape(stage.headline)}</h2>{_paragraphs(stage.sentences)}{code}"
        f"{''.join(_picture(one) for one in stage.pictures)}{''.join(_table(one) for one in stage.tables)}</section>"
    )


def _paragraphs(sentences: Iterable[str]) -> str:
    return f"<p>{' '.join(escape(one) for one in sentences if one)}</p>"


def _picture(picture: Picture) -> str:
    """A picture's plots as data beside their places, which the page's script draws."""
    title = f"<h3>{escape(picture.title)}</h3>" if picture.title else ""
    chips = "".join(
        f'<button type="button" data-label="{label}"><i style="background:{colour}"></i>{label}</button>'
        for label, colour in ((escape(label), colour) for label, colour in picture.legend())
    )
    plots = []
    for group in picture.groups:
        drawn = figure(group)
        data = json.dumps(drawn, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
        height = drawn["layout"]["height"]
        plots.append(
            f'<div class="plot" style="height:{height}px"><script type="application/json">{data}</script></div>'
        )
    columns = " ".join(f"{width}fr" for width in picture.columns)
    return (
        f'<figure>{title}<div class="legend">{chips}</div>'
        f'<div class="plots" style="--columns:{columns}">{"".join(plots)}</div>'
        f"<figcaption>{escape(picture.caption)}</figcaption></figure>"
    )


def _table(table: Table, folded: bool = True) -> str:
    head = "".join(f"<th>{escape(one)}</th>" for one in table.headings)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in table.rows)
    content = f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
    if not folded:
        return content
    return f"<details><summary>{escape(table.title)}</summary>{content}</details>"
