"""The page of an investigation: each test, and the possible sets of effects before and after it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
from pathlib import Path

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.investigation import ENDINGS, Investigation, Step
from eha_core.investigation.ending import sets_of
from eha_core.quantities import quantity, scale_for, short
from eha_core.recording import Channel
from eha_core.report.investigation_words import effect_in_words, probability_of, set_title
from eha_core.report.picture import COLOURS
from eha_core.report.wording import probable, sentence

_STYLE = """
section svg { display: block; width: 100%; max-width: 760px; height: 92px; margin: 2px 0 10px; }
section svg { background: var(--ground); }
section small { color: var(--quiet); font-size: 13px; }
section a { color: var(--accent); }
table { min-width: min(100%, 760px); } td { white-space: normal; }
.out td { color: var(--quiet); text-decoration: line-through; } .out td:last-child { text-decoration: none; }
"""
_POINTS = 600  # of a curve: more than its pixels
_WIDE, _HIGH = 760.0, 92.0  # units of a strip
_VERDICTS = {"resolved": "consistent", "nothing_more": "ambiguous", "stopped": "unknown_physics"}
"""The style sheet's class of each ending; the others have the default one."""


def page(state: Investigation) -> str:
    """The page, self-contained and complete after each step."""
    style = (files("eha_core.report") / "page.css").read_text(encoding="utf-8") + _STYLE
    ending = state.ending
    title = ENDINGS[ending.kind] if ending else "the investigation goes on"
    kind = _VERDICTS.get(ending.kind, "parameters") if ending else "parameters"
    headline = ending.statement if ending else "The next test is chosen where the predictions of the sets below differ."
    number = len(state.steps)
    tests = f"{number} test{'' if number == 1 else 's'}"
    return "\n".join([
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>Investigation of a rig</title>\n<style>{style}</style>\n</head>\n<body>\n<header>",
        f'<p class="file"><span class="verdict {kind}">{escape(title)}</span> {tests}; {escape(_limits(state))}</p>',
        f"<h1>{escape(sentence(headline))}</h1>{_effects(state.found)}</header>\n<main>",
        *(_step(state.steps, place) for place in range(number)),
        f"{_files(state)}</main>\n</body>\n</html>\n",
    ])  # fmt: skip


def _limits(state: Investigation) -> str:
    units = {"position": "m", "speed": "m/s", "pressure": "Pa", "energy": "J", "voltage": "V"}
    given = {name: value for name, value in vars(state.limits).items() if np.isfinite(value)}
    return "limits: " + ", ".join(f"{name} {quantity(value, units[name])}" for name, value in given.items())


def _effects(found: Diagnosis | None) -> str:
    items = "".join(f"<li>{escape(effect_in_words(effect))}, 95 %</li>" for effect in found.effects) if found else ""
    return f'<ul class="supporting">{items}</ul>' if items else ""


def _step(steps: Sequence[Step], place: int) -> str:
    """One test: its purpose, the voltage and the measured position, and the possible sets before and after it."""
    step, number = steps[place], place + 1
    before = steps[place - 1].diagnosis if place else None
    test, name = step.test, Path(step.recording.path).name
    curves = "".join(
        _strip(step.recording.channels[channel], title, unit, COLOURS[role])
        for channel, title, unit, role in (("voltage_command", "voltage", "V", "calibrated"),
                                           ("position", "position", "m", "measured"))
        if channel in step.recording.channels
    )  # fmt: skip
    return (
        f'<section id="test_{number}"><p class="step"><span>{number}</span>Test {number}</p>'
        f"<h2>A {test.signal.signal} of voltage for {test.duration:g} s</h2>"
        f"<p>{escape(sentence(test.signal.settings()))} Its purpose: {escape(test.purpose)}.</p>{curves}"
        f"{_sets(before, step.diagnosis)}<p>{escape(step.diagnosis.summary)}</p>"
        f'<p><a href="{escape(name)}">{escape(name)}</a>; the test and its diagnosis took {step.seconds:.0f} s</p>'
        "</section>"
    )


def _sets(before: Diagnosis | None, after: Diagnosis) -> str:
    """The sets of effects that were possible before a test and those after it, with probabilities."""
    were, are = sets_of(before) if before else (), sets_of(after)
    rows = []
    for ids in dict.fromkeys((*are, *were)):
        cells = (
            set_title(ids),
            _chance(before, ids, were) if before else "not known",
            _chance(after, ids, are) if ids in are else "excluded",
        )
        rows.append((cells, "" if ids in are else "out"))
    return _table(("set of effects", "before the test", "after it"), rows)


def _chance(found: Diagnosis | None, ids: tuple[str, ...], possible: Sequence[tuple[str, ...]]) -> str:
    if found is None or ids not in possible:
        return "not considered"
    probability = probability_of(found, ids)
    if probability is None:
        return "the only one" if len(possible) == 1 else "a rival"
    return probable(probability)


def _table(head: Sequence[str], rows: Iterable[tuple[Sequence[str], str]]) -> str:
    headings = "".join(f"<th>{escape(heading)}</th>" for heading in head)
    body = "".join(f'<tr class="{kind}">{_cells(head, row)}</tr>' for row, kind in rows)
    return f'<div class="scroll"><table><thead><tr>{headings}</tr></thead><tbody>{body}</tbody></table></div>'


def _cells(head: Sequence[str], row: Sequence[str]) -> str:
    return "".join(
        f'<td data-label="{escape(heading)}">{escape(cell)}</td>' for heading, cell in zip(head, row, strict=True)
    )


def _strip(channel: Channel, title: str, unit: str, colour: str) -> str:
    """A channel over time as a small curve, with its range in words."""
    every = max(1, len(channel.time) // _POINTS)
    time, values = channel.time[::every], channel.values[::every]
    low, high = float(np.min(channel.values)), float(np.max(channel.values))
    begin, end = float(channel.time[0]), float(channel.time[-1])
    x = _WIDE * (time - begin) / ((end - begin) or 1.0)
    y = 4.0 + (_HIGH - 8.0) * (high - values) / ((high - low) or 1.0)
    points = " ".join(f"{one:.1f},{other:.1f}" for one, other in zip(x, y, strict=True))
    scale = scale_for(unit, max(abs(low), abs(high)))
    span = f"{title}, {short(low / scale.factor)} to {short(high / scale.factor)} {scale.unit} in {end - begin:.1f} s"
    return (
        f'<small>{escape(span)}</small><svg viewBox="0 0 {_WIDE:g} {_HIGH:g}" preserveAspectRatio="none" role="img"'
        f' aria-label="{escape(span)}"><polyline fill="none" stroke="{colour}" stroke-width="1.2" points="{points}"/>'
        "</svg>"
    )


def _files(state: Investigation) -> str:
    """Links to the files beside the page once the investigation has ended."""
    if state.ending is None or state.found is None:
        return ""
    links = {"diagnosis/report.html": "the diagnosis of all tests together",
             "diagnosis/fitted.yaml": "starts the simulator with the fitted values",
             "investigation.json": "the investigation for programs"}  # fmt: skip
    rows = "".join(f'<li><a href="{path}">{path}</a>: {what}</li>' for path, what in links.items())
    return f"<footer><h3>Files beside this page</h3><ul>{rows}</ul></footer>"
