"""The document that a tool or method writes, schema "eha.diagnosis/1": what of it the exam reads, and in which form."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def _text(value: object) -> bool:
    return isinstance(value, str)


def _number(value: object) -> bool:
    return isinstance(value, (int, float))


def _pair(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(item is None or _number(item) for item in value)


Form = Callable[[object], bool] | dict[str, Any] | list[Any]

_SET: Form = {"effects": [_text]}
FORM: Form = {
    "verdict": _text,
    "effects?": [
        {
            "id": _text,
            "site": _text,
            "probability?": _number,
            "parameters?": {"*": {"value?": _number, "std?": _number}},
        }
    ],
    "alternatives?": [_SET],
    "sets?": [_SET],
    "location?": [{"site": _text}],
    "unknown?": {"site": _text, "function_of?": _text, "samples?": [_pair]},
    "parameters?": [{"name": _text, "fitted?": _number, "std?": _number}],
    "fit?": {"held_out?": {"*": {"rmse_after?": _number, "noise?": _number}}},
    "explained?": {"complete?": lambda value: isinstance(value, bool)},
    "next_experiment?": {"reference?": {}, "duration?": _number, "record?": [_text]},
}
"""What the exam reads. A name that ends in ? may be missing or null, * stands for any name; all else is ignored."""


def read_document(path: Path) -> tuple[dict[str, Any] | None, str]:
    """What was written at `path`, and "". None where that is nothing usable, and why: such an answer has failed."""
    if not path.is_file():
        return None, f"{path.name} was not written"
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        return None, f"{path.name} is no JSON ({error})"
    fault = fault_of(document)
    return (None, f"{path.name}: {fault}") if fault else (document, "")


def fault_of(document: object, form: Form = FORM, where: str = "the document") -> str:
    """What of a document is not of the form, "" where nothing is."""
    if isinstance(form, dict):
        return _fault_of_mapping(document, form, where)
    if isinstance(form, list):
        if not isinstance(document, list):
            return f"{where} is no list"
        faults = (fault_of(item, form[0], f"{where}[{place}]") for place, item in enumerate(document))
        return next(filter(None, faults), "")
    return "" if form(document) else f"{where} is of a wrong kind"


def _fault_of_mapping(document: object, form: dict[str, Any], where: str) -> str:
    if not isinstance(document, dict):
        return f"{where} is no object"
    for name, inner in form.items():
        bare = name.removesuffix("?")
        values = document if name == "*" else {bare: document.get(bare)}
        for key, value in values.items():
            if value is None:
                if name == bare:
                    return f"{where} has no {key}"
                continue
            if fault := fault_of(value, inner, key if where == "the document" else f"{where}.{key}"):
                return fault
    return ""
