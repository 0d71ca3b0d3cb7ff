"""Each headline of a page against the numbers that it stands over, and that a false one is found out."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest
from headlines import headlines, hold_against, key_answers

from eha_core.diagnosis.result import Diagnosis
from eha_core.report.document import as_json
from eha_core.report.html import page


def test_every_headline_is_true_of_the_numbers(any_diagnosis: Diagnosis) -> None:
    text = page(any_diagnosis)
    assert set(headlines(text)) == {"first", "read", "calibrate", "locate", "name", "model", "show", "next"}
    hold_against(text, json.loads(as_json(any_diagnosis)))


def test_the_page_answers_what_an_engineer_asks_first(friction: Diagnosis, ambiguous: Diagnosis) -> None:
    answers = key_answers(page(friction))
    assert list(answers) == ["How much better?", "How large is the residual?", "How sure?"]
    assert answers["How large is the residual?"][0] == "Noise"
    assert answers["How sure?"][0] == "Next explanation 31 behind"
    assert answers["How sure?"][1].endswith("Next: Stribeck friction. Nothing added: 5,321 behind.")
    answer, basis = key_answers(page(ambiguous))["How sure?"]
    assert answer == "Not the only explanation"
    assert "Stribeck friction" in basis


def _larger_rest(document: dict) -> None:
    document["fit"]["held_out"]["position"]["rmse_after"] *= 1.3


def _coloured(document: dict) -> None:
    document["whiteness"]["position"] = 9.0


def _other_value(document: dict) -> None:
    document["effects"][0]["parameters"]["force"]["value"] *= 1.02


def _wider(document: dict) -> None:
    document["effects"][0]["parameters"]["force"]["std"] *= 1.3


def _one_more(document: dict) -> None:
    document["effects"].append({**document["effects"][0], "id": "end_stop"})


def _another_is_better(document: dict) -> None:
    document["rivals"][1]["score"] = document["rivals"][0]["score"] + 1.0


def _another_share(document: dict) -> None:
    document["location"][0]["share"] -= 0.1


def _unchanged(document: dict) -> None:
    document["parameters"][0]["changed"] = False


def _shorter(document: dict) -> None:
    document["recording"]["duration_s"] -= 1.0


def _open(document: dict) -> None:
    document["verdict"] = "ambiguous"


@pytest.mark.parametrize(
    "falsify",
    [_larger_rest, _coloured, _other_value, _wider, _one_more, _another_is_better, _another_share, _unchanged, _shorter,
     _open],
)  # fmt: skip
def test_a_headline_over_other_numbers_is_found_out(friction: Diagnosis, falsify: Callable[[dict], None]) -> None:
    document = json.loads(as_json(friction))
    falsify(document)
    with pytest.raises(AssertionError):
        hold_against(page(friction), document)
