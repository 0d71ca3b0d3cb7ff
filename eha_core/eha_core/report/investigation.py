"""An investigation as text for the terminal and as a JSON document; its page is in `investigation_page`."""

from __future__ import annotations

import json
from math import isfinite
from pathlib import Path
from textwrap import wrap
from typing import Any

from eha_core.errors import EhaError
from eha_core.investigation import ENDINGS, Investigation, Step
from eha_core.investigation.ending import sets_of
from eha_core.report.investigation_page import page
from eha_core.report.investigation_words import effect_in_words, possible_sets, probability_of

SCHEMA = "eha.investigation/1"
PAGE, DOCUMENT = "investigation.html", "investigation.json"

_WIDTH = 100


def document(state: Investigation) -> dict[str, Any]:
    """The investigation as plain JSON types, SI throughout; `ending` is null while it runs."""
    limits = {name: value if isfinite(value) else None for name, value in vars(state.limits).items()}
    ending = state.ending
    return {
        "schema": SCHEMA,
        "limits": limits,
        "steps": [_step(step) for step in state.steps],
        "ending": None if ending is None else {"kind": ending.kind, "statement": ending.statement},
    }


def _step(step: Step) -> dict[str, Any]:
    found = step.diagnosis
    return {
        "test": {"signal": step.test.signal.signal, "parameters": dict(step.test.signal.parameters),
                 "duration": step.test.duration, "purpose": step.test.purpose},
        "recording": str(step.recording.path),
        "seconds": step.seconds,
        "verdict": found.verdict,
        "summary": found.summary,
        "sets": [{"effects": list(ids), "probability": probability_of(found, ids)} for ids in sets_of(found)],
    }  # fmt: skip


def step_account(state: Investigation) -> str:
    """The last step as text for the terminal."""
    step, number = state.steps[-1], len(state.steps)
    signal = f"a {step.test.signal.signal} of voltage ({step.test.signal.settings()}) for {step.test.duration:g} s"
    lines = wrap(f"Test {number}: {signal}", _WIDTH, subsequent_indent="  ")
    for text in (f"purpose: {step.test.purpose}", f"possible: {possible_sets(step.diagnosis)}"):
        lines += wrap(text, _WIDTH, initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def ending_account(state: Investigation, folder: Path) -> str:
    """How it ended and what was found, as text for the terminal."""
    lines = []
    if state.ending is not None:
        text = f"Ended: {ENDINGS[state.ending.kind]}. {state.ending.statement}"
        lines += wrap(text, _WIDTH, subsequent_indent="  ")
    for effect in state.found.effects if state.found is not None else ():
        lines += wrap(f"Named: {effect_in_words(effect)}, 95 %", _WIDTH, subsequent_indent="  ")
    return "\n".join([*lines, f"Page: {folder / PAGE}"])


def write_investigation(state: Investigation, folder: Path) -> tuple[Path, ...]:
    """Write investigation.html and investigation.json into a folder, made when missing; return their paths.

    Raises EhaError where the folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / DOCUMENT).write_text(json.dumps(document(state), indent=2, allow_nan=False) + "\n", encoding="utf-8")
        (folder / PAGE).write_text(page(state), encoding="utf-8")
    except OSError as error:
        raise EhaError(
            f"{error.filename or folder}: cannot be written ({error.strerror}); choose another directory"
        ) from error
    return folder / PAGE, folder / DOCUMENT
