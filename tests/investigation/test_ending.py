"""When an investigation is over, by what a diagnosis leaves open."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from eha_core.diagnosis.criteria import CHANCE
from eha_core.diagnosis.result import Alternative, Experiment, ProbableSet
from eha_core.investigation.ending import sets_of, settled

SINE = {"mode": "voltage", "signal": "sine", "sine.amplitude": 0.1, "sine.frequency": 3.0}
TELLS = Experiment("a sine should tell them apart", ("a", "b"), SINE, expected=4.0 * CHANCE)


def diagnosis(verdict: str = "ambiguous", rivals: tuple[str, ...] = ("b",), test: Experiment | None = TELLS):
    return SimpleNamespace(
        verdict=verdict,
        summary="Physics is missing.",
        effects=(SimpleNamespace(id="a"),),
        alternatives=tuple(Alternative((rival,), 1.0) for rival in rivals),
        sets=(ProbableSet(("a",), 0.9),),
        next_experiment=test,
    )


def test_rivals_and_a_test_that_tells_go_on() -> None:
    assert settled([diagnosis()]) is None
    assert settled([diagnosis(rivals=("b", "c")), diagnosis()]) is None


@pytest.mark.parametrize("verdict", ["consistent", "parameters", "missing_physics"])
def test_one_set_that_remains_resolves(verdict: str) -> None:
    ending = settled([diagnosis(), diagnosis(verdict, (), None)])
    assert (ending.kind, ending.statement) == ("resolved", "Physics is missing.")


def test_a_member_that_is_not_certain_leaves_two_sets_without_a_test() -> None:
    found = diagnosis("missing_physics", (), None)
    found.sets = (ProbableSet(("a",), 0.9), ProbableSet(("a", "b"), 0.08))
    ending = settled([found])
    assert ending.kind == "nothing_more" and "No test is proposed that distinguishes the remaining" in ending.statement


@pytest.mark.parametrize(
    ("found", "text"),
    [
        (diagnosis("unknown_physics", (), None), "no set of effects of the catalogue explains the tests"),
        (diagnosis(test=Experiment("no signal is proposed", ("a", "b"), {})), "no signal is proposed"),
        (diagnosis(test=Experiment("a sine", ("a", "b"), SINE, ("pressure_a", "pressure_b"), expected=900.0)),
         "pressure_a and pressure_b would have to be recorded too"),
        (diagnosis(test=Experiment("it hardly tells them apart", ("a", "b"), SINE, expected=CHANCE - 1.0)),
         "it hardly tells them apart"),
    ],
)  # fmt: skip
def test_where_no_test_tells_more_it_says_so(found: SimpleNamespace, text: str) -> None:
    ending = settled([found])
    assert ending.kind == "nothing_more"
    assert text in ending.statement


def test_a_test_that_left_the_same_rivals_is_not_made_again() -> None:
    ending = settled([diagnosis(), diagnosis()])
    assert ending.kind == "nothing_more" and "left the same rivals" in ending.statement
    other = Experiment("another", ("a", "b"), {**SINE, "sine.frequency": 8.0}, expected=900.0)
    assert settled([diagnosis(), diagnosis(test=other)]) is None


def test_the_sets_are_those_of_the_collection_and_the_rivals_once_each() -> None:
    found = diagnosis(rivals=("b", "a"))
    assert sets_of(found) == (("a",), ("b",))
    assert sets_of(SimpleNamespace(effects=(), alternatives=(), sets=())) == ((),)
