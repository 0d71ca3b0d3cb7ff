"""Holds every headline of a page against the numbers of its diagnosis.json; one that nothing is held against fails."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from html import unescape
from typing import Any

import numpy as np

SCALES = {
    "nm": 1e-9, "µm": 1e-6, "mm": 1e-3, "m": 1.0, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6,
    "N": 1.0, "kN": 1e3, "µA": 1e-6, "mA": 1e-3, "A": 1.0,
}  # fmt: skip
COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")
NOISE, WHITE, TOLD_APART = 1.1, 3.5, 10.0
Document = Mapping[str, Any]
Check = Callable[[Document, re.Match[str]], None]


def headlines(page: str) -> dict[str, str]:
    """The first sentence of a page, then each stage's headline, by the stage's name."""
    found = {"first": re.search(r"<h1>(.*?)</h1>", page, re.DOTALL)}
    stages = re.findall(r'<section id="(\w+)">.*?<h2>(.*?)</h2>', page, re.DOTALL)
    assert found["first"] is not None
    return {name: plain(text) for name, text in [("first", found["first"][1]), *stages]}


def key_answers(page: str) -> dict[str, tuple[str, str]]:
    """The questions at the top of a page, each with its answer and what that rests on."""
    rows = re.findall(r"<dt>(.*?)</dt><dd><b>(.*?)</b>(.*?)</dd>", page)
    return {plain(question): (plain(answer), plain(basis)) for question, answer, basis in rows}


def plain(text: str) -> str:
    return " ".join(unescape(text).split())


def hold_against(page: str, document: Document) -> None:
    """Every headline and every answer at the top of a page against the document's numbers."""
    for stage, text in headlines(page).items():
        for pattern, check in CHECKS[stage].items():
            match = re.fullmatch(pattern, text)
            if match:
                check(document, match)
                break
        else:
            raise AssertionError(f"nothing holds {text!r} of {stage} against a number")
    answers = key_answers(page)
    if "How much better?" in answers:
        _better(document, *answers["How much better?"])
    assert ("How close is the model?" in answers) == (document["verdict"] == "consistent" and bool(judged(document)))
    if "How close is the model?" in answers:
        _close(document, *answers["How close is the model?"])
    if "How large is the residual?" in answers:
        _rest(document, re.fullmatch("(.*)", answers["How large is the residual?"][0]))
        _ratios(document, answers["How large is the residual?"][1])
    if "How sure?" in answers:
        _sure(document, *answers["How sure?"])


def judged(document: Document) -> Mapping[str, Mapping[str, float]]:
    return document["fit"]["held_out"] or document["fit"]["training"]


def ratio(document: Document) -> float:
    return max(one["rmse_after"] / one["noise"] for one in judged(document).values())


def is_white(document: Document) -> bool:
    return all(one <= WHITE for one in document["whiteness"].values())


def titles(document: Document) -> list[str]:
    return [one["id"].replace("_", " ") for one in document["effects"]]


def _named(document: Document, match: re.Match[str]) -> None:
    """All effects and no other are named; where values stand beside them, they are the fitted ones, 1.96 deviations
    to either side."""
    text = match[0].lower()
    assert all(title in text for title in titles(document))
    counted = re.search(r"leaves out (\w+) effects", text)
    assert counted is None or COUNTS.index(counted[1]) == len(document["effects"])
    assert ("most likely" in text) == (document["verdict"] == "ambiguous")
    complete = document["explained"] is None or document["explained"]["complete"]
    assert ("more that is not named" in text) == (not complete)
    law = document["unknown"]
    assert ("a law over" in text) == (law is not None)
    assert law is None or f"a law over {law['function_of']} that is not in the catalogue" in text
    _values(document, match)


def _values(document: Document, match: re.Match[str]) -> None:
    fitted = [
        (name.replace("_", " "), one) for effect in document["effects"] for name, one in effect["parameters"].items()
    ]
    shown = re.findall(r"([a-z ]+) (-?[\d.,]+) ± ([\d.,]+) (\S+?)[),;]", match[0])
    assert bool(shown) == ("±" in match[0])
    for name, value, half, unit in shown:
        size, wide = (float(one.replace(",", "")) for one in (value, half))
        rows = [one for title, one in fitted if title == name.strip()]
        assert any(
            abs(size * SCALES[unit] - one["value"]) < 2e-3 * abs(one["value"])
            and abs(wide * SCALES[unit] - 1.96 * one["std"]) < 0.06 * 1.96 * one["std"]
            for one in rows
        ), (name, value, half, unit)


def _nothing_missing(document: Document, match: re.Match[str]) -> None:
    assert not document["effects"]
    assert document["verdict"] in ("consistent", "parameters")


def _something_missing(document: Document, match: re.Match[str]) -> None:
    assert document["verdict"] == "unknown_physics"
    assert not document["effects"]


def _recorded(document: Document, match: re.Match[str]) -> None:
    assert abs(float(match[1]) - document["recording"]["duration_s"]) <= 0.05
    pairs = {"both chamber pressures": ("pressure_a", "pressure_b"), "both chamber flows": ("flow_a", "flow_b")}
    for title in re.split(r", | and ", match[2]):
        names = pairs.get(title, (title.replace(" ", "_"),))
        assert set(names) <= set(document["recording"]["channels"]), title


def _changed(document: Document, match: re.Match[str]) -> None:
    """The parameters named have left their nominal values beyond their intervals, and so has each that is counted."""
    changed = [one for one in document["parameters"] if one["changed"]]
    assert changed
    assert all(abs(one["fitted"] - one["nominal"]) > 1.96 * one["std"] for one in changed)
    if match[0][0].isdigit():
        assert int(match[1]) == len(changed)
    else:
        assert {one.lower() for one in re.split(r", | and ", match[1])} == {
            one["name"].replace("_", " ").replace("@", ", recording ") for one in changed
        }


def _unchanged(document: Document, match: re.Match[str]) -> None:
    assert not any(one["changed"] for one in document["parameters"])


def _located(document: Document, match: re.Match[str]) -> None:
    first = document["location"][0]
    assert float(match[1]) / 100.0 == round(first["share"], 2)
    assert first["share"] == max(one["share"] for one in document["location"])
    spans = re.search(r"in (\d+) intervals, the first from ([\d.]+) s", match[0])
    if spans:
        assert int(spans[1]) == len(first["when"])
        assert abs(float(spans[2]) - first["when"][0][0]) <= 0.051
    shown = re.search(r"from ([\d.]+) s to ([\d.]+) s", match[0])
    if shown:
        assert np.allclose([float(shown[1]), float(shown[2])], first["when"][0], atol=0.01)


def _no_location(document: Document, match: re.Match[str]) -> None:
    assert not document["location"]


def _best(document: Document, match: re.Match[str]) -> None:
    """What the evidence points to has the highest score of all, and by how much the verdict says."""
    assert document["effects"]
    assert ("a law that is not in the catalogue" in match[0]) == (document["unknown"] is not None)
    assert all(title in match[0].lower() for title in titles(document))
    chosen = {one["id"] for one in document["effects"]}
    scores = {frozenset(one["effects"]): one["score"] for one in document["rivals"]}
    if frozenset(chosen) in scores:
        assert scores[frozenset(chosen)] >= 10.0
        assert scores[frozenset(chosen)] == max(scores.values()) or document["verdict"] == "ambiguous"
    assert bool(document["alternatives"]) == ("not the only one" in match[0])


def _named_alone(document: Document) -> None:
    assert document["verdict"] in ("missing_physics", "ambiguous")
    assert document["effects"]


def _law(document: Document, match: re.Match[str]) -> None:
    assert document["unknown"]["function_of"] == match[1]
    assert document["unknown"]["r_squared"] > 0.5


def _stands(document: Document, match: re.Match[str]) -> None:
    assert not document["effects"]
    assert document["unknown"] is None
    assert (match[1] == "with the fitted parameters") == (document["verdict"] == "parameters")


def _rest(document: Document, match: re.Match[str] | None) -> None:
    assert match is not None
    text = match[1].lower()
    if text == "noise":
        assert ratio(document) < NOISE
        assert is_white(document)
    elif text.startswith("as small"):
        assert ratio(document) < NOISE
        assert not is_white(document)
    else:
        size = re.fullmatch(r"up to ([\d.]+) times the noise", text)
        assert size is not None
        assert abs(float(size[1]) - ratio(document)) <= 0.051
        assert ratio(document) >= NOISE


def _ratios(document: Document, basis: str) -> None:
    shown = [float(one) for one in re.findall(r"([\d.]+)(?= to| times)", basis)]
    all_of_them = [one["rmse_after"] / one["noise"] for one in judged(document).values()]
    assert np.allclose([min(shown), max(shown)], [min(all_of_them), max(all_of_them)], atol=0.0051)
    largest = re.search(r"largest autocorrelation ([\d.]+)", basis)
    assert largest is not None
    assert abs(float(largest[1]) - max(document["whiteness"].values())) <= 0.051
    assert ("not white" in basis) == (not is_white(document))


def _better(document: Document, answer: str, basis: str) -> None:
    shown = re.findall(r"([\d.,]+) (\S+)", f"{answer} {basis.rpartition('noise is ')[2].rstrip('.')}")
    name = "position" if "position" in judged(document) else next(iter(judged(document)))
    fit = judged(document)[name]
    match = [float(one.replace(",", "")) * SCALES[unit] for one, unit in shown]
    assert np.allclose(match, [fit["rmse_before"], fit["rmse_after"], fit["noise"]], rtol=6e-3)
    assert ("held-out" in basis) == bool(document["fit"]["held_out"])


def _close(document: Document, answer: str, basis: str) -> None:
    shown = re.findall(r"([\d.,]+) (\S+)", f"{answer} {basis.rpartition('noise is ')[2].rstrip('.')}")
    name = "position" if "position" in judged(document) else next(iter(judged(document)))
    match = [float(one.replace(",", "")) * SCALES[unit] for one, unit in shown]
    assert np.allclose(match, [judged(document)[name][one] for one in ("rmse_before", "noise")], rtol=6e-3)


def _sure(document: Document, answer: str, basis: str) -> None:
    if document["alternatives"]:
        assert answer == "Not the only explanation"
        return
    chosen = {one["id"] for one in document["effects"]}
    scores = {frozenset(one["effects"]): one["score"] for one in document["rivals"]}
    if answer == "Each effect is needed":
        least, shown = min(one["overall"] for one in document["without"].values()), re.findall(r"\d+\.?\d*", basis)
        assert np.allclose([float(one) for one in shown], [least, document["steps"][-1]["overall"]], rtol=6e-3)
        assert least > document["steps"][-1]["overall"]
        return
    others = [score for effects, score in scores.items() if effects != chosen and len(effects) >= len(chosen)]
    gaps = (scores[frozenset(chosen)] - max(others), scores[frozenset(chosen)])
    for text, gap in zip((answer, basis.rpartition("Nothing added: ")[2]), gaps, strict=True):
        shown = re.search(r"([\d.,]+)( million)? behind", text)
        assert shown is not None
        size = float(shown[1].replace(",", "")) * (1e6 if shown[2] else 1.0)
        assert abs(size - gap) <= max(0.5, 6e-3 * gap)
    assert gaps[0] >= TOLD_APART


def _test(document: Document, match: re.Match[str]) -> None:
    separates = document["next_experiment"]["separates"]
    assert [one.replace("_", " ") for one in separates[:2]] == [match[1].lower(), match[2].lower()]


def _no_test(document: Document, match: re.Match[str]) -> None:
    assert document["next_experiment"] is None
    settled = document["verdict"] not in ("ambiguous", "unknown_physics")
    assert settled == ("needed" in match[0])


CHECKS: Mapping[str, Mapping[str, Check]] = {
    "first": {
        r"The model (most likely )?leaves out .*": _named,
        r"Nothing is missing.*": _nothing_missing,
        r"(Parameters differ|The model stands|No physics).*": _nothing_missing,
        r"(Something|A force|A law) .*missing.*": _something_missing,
    },
    "read": {r"([\d.]+) s of (.*)": _recorded},
    "calibrate": {
        r"(\d+) parameters of the nominal model have to change": _changed,
        r"No parameter of the nominal model has to change": _unchanged,
        r"(.*) differs? from the nominal model": _changed,
    },
    "locate": {
        r"(\d+) ?% .*": _located,
        r"No equation is violated|No mismatch remains that an effect would explain": _no_location,
    },
    "name": {
        r"The evidence points to (.*)": _best,
        r"The best explanation is (.*), but it is not the only one": _best,
        r"(Nothing needs to be added to the model|Other parameter values suffice.*)": _nothing_missing,
        r"Nothing in the catalogue explains it": _something_missing,
    },
    "model": {
        r"A law over (.*) is missing": _law,
        r"The model stands (.*)": _stands,
        r".*": lambda document, match: (_named_alone(document), _values(document, match))[0],
    },
    "show": {r"The residual is (.*)": _rest},
    "next": {
        r"One more test would distinguish (.*) from (.*)": _test,
        r"(No further experiment is needed|No test is proposed)": _no_test,
    },
}
