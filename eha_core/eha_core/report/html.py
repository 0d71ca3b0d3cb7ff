"""The report as one self-contained page: text, tables and interactive figures."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template

from plotly.offline import get_plotlyjs

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.contents import Contents, contents_of
from eha_core.report.contribution import effect_table
from eha_core.report.experiment_file import FILE
from eha_core.report.finding import headline, supporting, warnings
from eha_core.report.key_figures import KeyFigure, key_figures
from eha_core.report.picture import Picture
from eha_core.report.plotly_drawing import figure
from eha_core.report.stage import Part, Stage, Table
from eha_core.report.stages.show import error_table
from eha_core.report.wording import VERDICT_TITLES, words


def page(diagnosis: Diagnosis, contents: Contents | None = None) -> str:
    """The whole page as text."""
    contents = contents or contents_of(diagnosis)
    return filled_page(
        title=escape(f"Diagnosis of {Path(diagnosis.path).name}"),
        recording=escape(Path(diagnosis.path).name),
        verdict=diagnosis.verdict,
        verdict_title=escape(VERDICT_TITLES[diagnosis.verdict]),
        warnings="".join(f'<p class="warning" role="alert">{escape(warning)}</p>' for warning in warnings(diagnosis)),
        headline=html_text(headline(diagnosis)),
        key_figures="".join(map(html_key_figure, key_figures(diagnosis))),
        supporting="".join(f"<li>{html_text(sentence)}</li>" for sentence in supporting(diagnosis)),
        summary=titled_table(effect_table(diagnosis), "summary") if len(diagnosis.effects) > 1 else "",
        proof="".join(html_picture(picture) for picture in contents.first_screen),
        errors=titled_table(error_table(diagnosis), "errors"),
        files=_files(diagnosis),
        provenance=html_provenance(diagnosis),
        steps="".join(
            f'<a href="#{stage.name}"><span>{number}</span>{escape(stage.title)}</a>'
            for number, stage in enumerate(contents.stages, start=1)
        ),
        stages="".join(_stage(number, stage) for number, stage in enumerate(contents.stages, start=1)),
    )


def filled_page(**parts: str) -> str:
    """The page with these parts in its places, as HTML, its style and its script."""
    template = Template((files("eha_core.report") / "page.html").read_text(encoding="utf-8"))
    own = {name: (files("eha_core.report") / f"page.{kind}").read_text(encoding="utf-8")
           for name, kind in (("style", "css"), ("script", "js"))}  # fmt: skip
    return template.substitute(**own, plotly=get_plotlyjs(), **parts)


def write_page(diagnosis: Diagnosis, path: Path, contents: Contents | None = None) -> None:
    """Write the page to `path`."""
    path.write_text(page(diagnosis, contents), encoding="utf-8")


UNIT_BEHIND = re.compile(r"(?<=\d)(?: (?=[%°µ×±A-Za-z])|(?=%))|(?<=±) ")
"""The space between a number and its unit, which a per cent sign may lack."""

FILES = {
    "fitted.yaml": "starts the simulator with the fitted values",
    "comparison.mcap": "measured, nominal, recalibrated and augmented model and residuals, for PlotJuggler or Foxglove",
    "diagnosis.json": "the result for programs",
}


def html_key_figure(key_figure: KeyFigure) -> str:
    """A question with its answer."""
    return (
        f"<div><dt>{html_text(key_figure.question)}</dt><dd><b>{html_text(key_figure.answer)}</b>"
        f"{html_text(key_figure.basis)}</dd></div>"
    )


def html_text(words: str) -> str:
    """Text as HTML; a number and its unit stay on one line."""
    return escape(re.sub(UNIT_BEHIND, "\N{NO-BREAK SPACE}", words))


def _files(diagnosis: Diagnosis) -> str:
    """Links to the files beside the page."""
    test = diagnosis.next_experiment
    proposed = {FILE: "the next experiment, for the reference node"} if test and test.reference else {}
    rows = (f'<li><a href="{name}">{name}</a>: {escape(what)}</li>' for name, what in {**FILES, **proposed}.items())
    return "".join(rows)


def html_provenance(diagnosis: Diagnosis) -> str:
    """The diagnosis' provenance as a list; empty if not known."""
    rows = (f"<dt>{escape(words(name))}</dt><dd>{escape(text)}</dd>" for name, text in diagnosis.provenance.items())
    return "".join(rows)


def _stage(number: int, stage: Stage) -> str:
    code = f"<pre>{escape(stage.code)}</pre>" if stage.code else ""
    return (
        f'<section id="{stage.name}"><p class="step"><span>{number}</span>{escape(stage.title)}</p>'
        f"<h2>{html_text(stage.headline)}</h2>{_paragraphs(stage.sentences)}{code}"
        f"{''.join(_part(part) for part in stage.parts)}"
        f"{''.join(html_picture(picture) for picture in stage.pictures)}"
        f"{''.join(html_table(table) for table in stage.tables)}</section>"
    )


def _part(part: Part) -> str:
    """One finding beside its picture."""
    code = f"<pre>{escape(part.code)}</pre>" if part.code else ""
    return (
        f"<article><div><h3>{escape(part.title)}</h3>{_paragraphs(part.sentences)}{code}</div>"
        f"<div>{''.join(html_picture(picture) for picture in part.pictures)}</div></article>"
    )


def _paragraphs(sentences: Iterable[str]) -> str:
    return f"<p>{' '.join(html_text(sentence) for sentence in sentences if sentence)}</p>"


def html_picture(picture: Picture) -> str:
    """A picture's plots as JSON, which the page's script draws."""
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
    save = '<span class="save"><button type="button" data-as="svg">SVG</button>'
    save += '<button type="button" data-as="png">PNG</button></span>'
    return (
        f'<figure data-name="{picture.name}">{title}<div class="legend">{chips}{save}</div>'
        f'<div class="plots" style="--columns:{columns}">{"".join(plots)}</div>'
        f"<figcaption>{escape(picture.caption)}</figcaption></figure>"
    )


def _cells(headings: tuple[str, ...], row: tuple[str, ...]) -> str:
    """Cells labelled with their column, because a phone shows them below each other."""
    return "".join(
        f'<td data-label="{escape(heading)}">{escape(cell)}</td>' for heading, cell in zip(headings, row, strict=True)
    )


def titled_table(table: Table, kind: str) -> str:
    """A table below its title."""
    return f"<h3>{escape(table.title)}</h3>{html_table(table, folded=False, kind=kind)}"


def html_table(table: Table, folded: bool = True, kind: str = "") -> str:
    """A table, behind its title if it is `folded`."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in table.headings)
    body = "".join(f"<tr>{_cells(table.headings, row)}</tr>" for row in table.rows)
    content = (
        f'<div class="scroll"><table class="{kind}"><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'
    )
    if not folded:
        return content
    return f"<details><summary>{escape(table.title)}</summary>{content}</details>"
