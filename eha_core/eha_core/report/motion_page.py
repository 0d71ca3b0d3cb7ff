"""The report of a law of given motion as a page: what is certain, what remains, what to record next, and details."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from eha_core.effects import effect_title
from eha_core.motion_given import Found
from eha_core.quantities import quantity
from eha_core.report.finding import fitted_in_words, identified_parameters
from eha_core.report.html import filled_page, html_key_figure, html_picture, html_provenance, html_text, titled_table
from eha_core.report.key_figures import KeyFigure
from eha_core.report.motion_given import law_picture
from eha_core.report.stage import Table


def motion_page(found: Found) -> str:
    """The whole page as text."""
    diagnosis, sentences = found.diagnosis, found.sentences
    name = Path(diagnosis.path).name
    more = f" and {len(found.motions) - 1} more" if len(found.motions) > 1 else ""
    notes = (*(f"Not examined: {one}" for one in diagnosis.not_examined), *diagnosis.remarks)
    return filled_page(
        title=escape(f"Diagnosis of {name}"),
        recording=escape(name + more),
        verdict=diagnosis.verdict if found.law.holds else "unknown_physics",
        verdict_title="A law was found" if found.law.holds else "No law holds",
        warnings=f'<p class="warning" role="alert">{escape(diagnosis.damaged)}</p>' if diagnosis.damaged else "",
        headline=html_text(sentences.explained),
        key_figures="".join(map(html_key_figure, _key_figures(found))),
        supporting=_items((*sentences.parts, sentences.remains, sentences.next_recording)),
        summary=titled_table(effect_table(found), "summary"),
        proof=html_picture(law_picture(found)),
        errors=titled_table(error_table(found), "errors"),
        files='<li><a href="diagnosis.json">diagnosis.json</a>: the result for programs</li>',
        provenance=html_provenance(diagnosis),
        steps="",
        stages=f"<h3>Notes</h3><ul>{_items(notes)}</ul>",
    )


def _items(sentences: Sequence[str]) -> str:
    return "".join(f"<li>{html_text(sentence)}</li>" for sentence in sentences)


def _key_figures(found: Found) -> Iterator[KeyFigure]:
    """How much of the force the law explains, how much is left beside the noise, and how well it predicts."""
    diagnosis, law = found.diagnosis, found.law
    fit = diagnosis.training["force"]
    yield KeyFigure(
        "How much is explained?", f"all but {100.0 * law.share_left:.1f} %",
        "of the force's deviation, on stretches that were not fitted",
    )  # fmt: skip
    times = diagnosis.explained.times_noise.get("force") if diagnosis.explained else None
    noise = "its noise is not known: the recorded force was averaged"
    if times is not None:
        noise = f"{times:.3g} times the noise of {quantity(fit.noise, 'N')}"
    yield KeyFigure("What is left?", quantity(fit.rmse_after, "N"), f"RMS; {noise}")
    if diagnosis.tests:
        of_tests = diagnosis.held_out["force"]
        share = 100.0 * of_tests.rmse_after / of_tests.rmse_before
        yield KeyFigure(
            "Does it predict?", f"to {share:.1f} %",
            f"of the force's deviation in {len(diagnosis.tests)} test"
            f"{'' if len(diagnosis.tests) == 1 else 's'}: {quantity(of_tests.rmse_after, 'N')} RMS",
        )  # fmt: skip


def effect_table(found: Found) -> Table:
    """What was named, with its values and their 95 % intervals."""
    rows = []
    for effect in found.diagnosis.effects:
        for place, (name, value) in enumerate(identified_parameters(effect).items()):
            title, equation = (effect_title(effect.id), effect.equation) if place == 0 else ("", "")
            rows.append((title, name.replace("_", " "), fitted_in_words(value), equation))
    return Table(("part of the law", "parameter", "value, 95 %", "equation"), tuple(rows), "The law's parts")


def error_table(found: Found) -> Table:
    """RMS of the force about its mean, about viscous friction with a load, and about the law."""
    diagnosis = found.diagnosis
    fit = diagnosis.training["force"]
    rows = [_errors("fitted recordings", fit.rmse_before, fit.rmse_calibrated, fit.rmse_after)]
    for test in diagnosis.tests:
        errors = (test.prediction[model]["force"].free_running for model in ("nominal", "recalibrated", "augmented"))
        rows.append(_errors(f"test: {Path(test.path).name}", *errors))
    headings = ("force", "its deviation", "the law", "of the deviation", "viscous friction with a load alone")
    return Table(headings, tuple(rows), "RMS of the force that is left")


def _errors(name: str, deviation: float, line: float, law: float) -> tuple[str, ...]:
    share = f"{100.0 * law / deviation:.1f} %" if deviation > 0.0 else ""
    return name, quantity(deviation, "N"), quantity(law, "N"), share, quantity(line, "N")
