"""What a tool or method writes: the form that the exam reads, and answers that have failed by theirs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from eha_exam.document import fault_of, read_document

PLAIN: dict[str, Any] = {"schema": "eha.diagnosis/1", "verdict": "missing_physics", "effects": []}
EFFECT = {"id": "coulomb_friction", "site": "force"}


def test_verdict_and_effects_are_enough() -> None:
    assert fault_of({"verdict": "consistent"}) == ""
    assert fault_of(PLAIN | {"effects": [EFFECT], "unknown": None, "whatever": [1, {}]}) == ""


@pytest.mark.parametrize(
    ("document", "fault"),
    [
        ([], "the document is no object"),
        ({"effects": []}, "the document has no verdict"),
        (PLAIN | {"verdict": 3}, "verdict is of a wrong kind"),
        (PLAIN | {"effects": {}}, "effects is no list"),
        (PLAIN | {"effects": [EFFECT, {"id": "end_stop"}]}, "effects[1] has no site"),
        (PLAIN | {"effects": [EFFECT | {"parameters": {"force": 3.0}}]}, "effects[0].parameters.force is no object"),
        (PLAIN | {"effects": [EFFECT | {"parameters": {"force": None}}]}, "effects[0].parameters has no force"),
        (PLAIN | {"alternatives": [{}]}, "alternatives[0] has no effects"),
        (PLAIN | {"unknown": {"site": "force", "samples": [[1.0]]}}, "unknown.samples[0] is of a wrong kind"),
        (PLAIN | {"explained": {"complete": "yes"}}, "explained.complete is of a wrong kind"),
    ],
    ids=str,
)
def test_another_form_is_named_with_its_place(document: object, fault: str) -> None:
    assert fault_of(document) == fault


def test_a_file_that_cannot_be_used_is_no_answer(tmp_path: Path) -> None:
    path = tmp_path / "answer.json"
    assert read_document(path) == (None, "answer.json was not written")
    path.write_text("{", encoding="utf-8")
    assert "answer.json is no JSON" in read_document(path)[1]
    path.write_text("[]", encoding="utf-8")
    assert read_document(path) == (None, "answer.json: the document is no object")
    path.write_text(json.dumps(PLAIN), encoding="utf-8")
    assert read_document(path) == (PLAIN, "")
