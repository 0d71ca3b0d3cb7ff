"""The rules of scoring, each on an answer made for it, and Wilson's interval against its published values."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.outside import curve_agreement
from eha_exam.reliability import reliability
from eha_exam.scoring import Answer, Proportion, mark, wilson
from eha_exam.shares import confusion, summarise
from eha_exam.tiers import MEANINGS, SHARES, plan


def single(**changes: Any) -> Case:
    case = draw_case("single", 12, 0)
    return replace(case, effects=(("coulomb_friction", {"force": 200.0}),), **changes)


PAIR = (("coulomb_friction", {"force": 200.0}), ("command_delay", {"delay": 1e-4}))


def answer(verdict: str, *ids: str, **fields: Any) -> Answer:
    effects = [{"id": name, "site": "force", "parameters": {}} for name in ids]
    return Answer({"verdict": verdict, "effects": effects, **fields}, 0, 3.0)


@pytest.mark.parametrize(
    ("case", "given", "outcome"),
    [
        (single(), answer("missing_physics", "coulomb_friction"), "right"),
        (single(), answer("missing_physics", "stribeck_friction"), "wrong"),
        (single(), answer("missing_physics", "coulomb_friction", "end_stop"), "wrong"),
        (
            single(),
            answer("ambiguous", "stribeck_friction", alternatives=[{"effects": ["coulomb_friction"]}]),
            "abstained",
        ),
        (single(), answer("ambiguous", "stribeck_friction", alternatives=[{"effects": ["end_stop"]}]), "wrong"),
        (
            single(rivals=("stribeck_friction",)),
            answer("ambiguous", "stribeck_friction", alternatives=[{"effects": ["coulomb_friction"]}]),
            "right",
        ),
        (single(), answer("parameters"), "abstained"),
        (single(decidable=False), answer("consistent"), "right"),
        (replace(single(), effects=PAIR), answer("missing_physics", "coulomb_friction"), "wrong"),
        (replace(single(), effects=PAIR, decidable=False), answer("missing_physics", "coulomb_friction"), "right"),
        (replace(single(), effects=PAIR, decidable=False), answer("missing_physics", "end_stop"), "wrong"),
        (single(), answer("unknown_physics"), "wrong"),
        (
            single(windows={"coulomb_friction": (2.0, 4.0)}),
            answer("unknown_physics", unknown={"site": "force", "function_of": "time", "samples": []}),
            "abstained",
        ),
        (single(), Answer(None, 2, 1.0, "no usable channel"), "failed"),
        (replace(single(), effects=()), answer("consistent"), "right"),
        (replace(single(), effects=()), answer("missing_physics", "end_stop"), "wrong"),
        (
            replace(single(), effects=(("one_sided_spring", {"start": 0.0, "stiffness": 1e5}),)),
            answer("missing_physics", "end_stop"),
            "right",
        ),
        (
            replace(single(), effects=(("position_ripple", {"force": 100.0, "pitch": 0.01, "phase": 0.0}),)),
            answer("unknown_physics", unknown={"site": "force", "function_of": "position", "samples": []}),
            "right",
        ),
        (
            replace(single(), effects=(("position_ripple", {"force": 100.0, "pitch": 0.01, "phase": 0.0}),)),
            answer("unknown_physics", unknown={"site": "chamber", "function_of": "position", "samples": []}),
            "wrong",
        ),
    ],
)
def test_outcomes(case: Case, given: Answer, outcome: str) -> None:
    assert mark(case, given).outcome == outcome


def test_intervals_are_held_against_the_truth() -> None:
    case = single()
    effect = {
        "id": "coulomb_friction",
        "site": "force",
        "parameters": {"force": {"value": 203.0, "std": 2.0, "unit": "N"}},
    }
    mass = case.plant["moving_mass"]
    rows = [{"name": "moving_mass", "fitted": mass * 1.1, "std": 0.01 * mass}]
    marked = mark(case, Answer({"verdict": "missing_physics", "effects": [effect], "parameters": rows}, 0, 1.0))
    assert marked.intervals == (True,)
    assert marked.nominal_intervals == (False,)
    beside = replace(case, effects=PAIR, decidable=False)
    unnamed = mark(beside, Answer({"verdict": "missing_physics", "effects": [effect], "parameters": rows}, 0, 1.0))
    assert (unnamed.outcome, unnamed.intervals, unnamed.nominal_intervals) == ("right", (), ())


def test_parameters_of_an_equivalent_law_are_not_held_against_the_truth() -> None:
    case = replace(single(), effects=(("direction_friction", {"forward": 100.0, "backward": 300.0}),))
    effects = [
        {"id": name, "site": "force", "parameters": {"force": {"value": 1.0, "std": 1.0, "unit": "N"}}}
        for name in ("coulomb_friction", "constant_load")
    ]
    marked = mark(case, Answer({"verdict": "missing_physics", "effects": effects}, 0, 1.0))
    assert marked.outcome == "right"
    assert marked.intervals == ()


def test_a_recovered_curve_is_compared_up_to_what_the_nominal_model_absorbs() -> None:
    case = replace(single(), effects=(("position_ripple", {"force": 100.0, "pitch": 0.01, "phase": 0.3}),))
    x = np.linspace(-0.02, 0.02, 80)
    ripple = 100.0 * np.sin(2.0 * np.pi * x / 0.01 + 0.3)
    assert curve_agreement(case, "position", np.column_stack([x, ripple + 7.0 - 900.0 * x])) == pytest.approx(1.0)
    assert curve_agreement(case, "position", np.column_stack([x, 0.0 * x])) == pytest.approx(0.0)
    assert curve_agreement(case, "velocity", np.column_stack([x, ripple])) is None


def test_a_relief_valve_s_curve_begins_at_its_opening_and_has_one_way() -> None:
    relief = {"coefficient": 2e-11, "opening": 1e6, "direction": -1.0}
    case = replace(single(), effects=(("relief_leakage", relief),))
    d = np.linspace(-4e6, 4e6, 81)
    flow = np.where(d < -1e6, 2e-11 * (d + 1e6), 0.0)
    over = "pressure difference"
    assert curve_agreement(case, over, np.column_stack([d, flow + 3e-6 - 4e-12 * d])) == pytest.approx(1.0)
    other_way = np.where(d > 1e6, 2e-11 * (d - 1e6), 0.0)
    assert curve_agreement(case, over, np.column_stack([d, other_way])) < 0.0
    assert curve_agreement(case, "position", np.column_stack([d, flow])) is None


def test_wilson_intervals_as_published() -> None:
    # R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert wilson(15, 148) == pytest.approx((0.0624, 0.1605), abs=5e-5)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)
    assert wilson(1, 29) == pytest.approx((0.0061, 0.1718), abs=5e-5)


def test_a_short_exam_is_the_beginning_of_a_long_one() -> None:
    assert plan(1000)[:100] == plan(100)
    counts = {tier: sum(1 for t, _ in plan(1000) if t == tier) for tier in SHARES}
    assert all(abs(counts[tier] - 1000 * share) <= 1.0 for tier, share in SHARES.items())
    assert set(SHARES) == set(MEANINGS)
    assert sum(SHARES.values()) == pytest.approx(1.0)


RIG = (*PAIR, ("constant_load", {"force": 50.0}))


def test_of_several_effects_those_that_can_be_seen_must_be_named_and_no_other() -> None:
    hidden = single(tier="rig", decidable=False, seen=("coulomb_friction", "constant_load"))
    hidden = replace(hidden, effects=RIG)
    for named, outcome, exact in (
        (("coulomb_friction", "constant_load"), "right", True),
        (("coulomb_friction", "constant_load", "command_delay"), "right", True),
        (("coulomb_friction",), "wrong", False),
        (("coulomb_friction", "constant_load", "end_stop"), "wrong", False),
    ):
        one = mark(hidden, answer("missing_physics", *named))
        assert (one.outcome, one.exact) == (outcome, exact), named
        one = mark(hidden, answer("ambiguous", "end_stop", alternatives=[{"effects": list(named)}]))
        assert one.outcome == ("abstained" if exact else "wrong"), named
    assert mark(hidden, answer("parameters")).outcome == "abstained"
    assert mark(replace(hidden, seen=()), answer("parameters")).outcome == "right"


def test_complete_is_told_truly_where_no_channel_keeps_more_than_one_and_a_half_times_the_noise() -> None:
    for complete, after, truthful in ((True, 1.0, True), (True, 1.6, False), (False, 1.6, True)):
        fit = {"held_out": {"position": {"rmse_after": after, "noise": 1.0}}}
        given = answer("missing_physics", "coulomb_friction", fit=fit, explained={"complete": complete})
        assert mark(single(), given).truthful is truthful
    assert mark(single(), answer("missing_physics", "coulomb_friction")).truthful is None


def test_a_named_effect_and_an_unknown_law_are_right_together() -> None:
    both = (("coulomb_friction", {"force": 200.0}), ("position_ripple", {"force": 9.0, "pitch": 0.01, "phase": 0.0}))
    case = replace(single(), tier="named_and_unknown", effects=both)
    law = {"site": "force", "function_of": "position", "samples": []}
    assert mark(case, answer("unknown_physics", "coulomb_friction", unknown=law)).outcome == "right"
    assert mark(case, answer("unknown_physics", unknown=law)).outcome == "abstained"
    assert mark(case, answer("missing_physics", "coulomb_friction")).outcome == "wrong"


def test_an_unknown_law_that_effects_of_the_catalogue_express_is_named_beside_a_known_one() -> None:
    both = (("supply_pressure_droop", {}), ("direction_friction", {"forward": 100.0, "backward": 300.0}))
    case = replace(single(), tier="named_and_unknown", effects=both)
    right = mark(case, answer("missing_physics", "supply_pressure_droop", "coulomb_friction", "constant_load"))
    assert (right.outcome, right.false) == ("right", ())
    wrong = mark(case, answer("missing_physics", "supply_pressure_droop", "end_stop"))
    assert (wrong.outcome, wrong.false) == ("wrong", ("end_stop",))


def test_what_was_named_in_place_of_what_is_counted() -> None:
    wrong = mark(single(), answer("missing_physics", "stribeck_friction"))
    right = mark(single(), answer("missing_physics", "coulomb_friction"))
    assert confusion([wrong, wrong, right]) == [("coulomb_friction", "stribeck_friction", 2)]


def test_stated_probabilities_are_held_against_what_is_concealed() -> None:
    given = answer("missing_physics", "coulomb_friction", "end_stop")
    given.diagnosis["effects"][0]["probability"], given.diagnosis["effects"][1]["probability"] = 1.0, 0.6
    marked = mark(single(), given)
    assert marked.probabilities == ((1.0, True), (0.6, False))
    likely, sure = reliability([marked] * 30)
    assert (likely.low, likely.high, likely.observed) == (0.5, 0.8, Proportion(0, 30))
    assert likely.stated == pytest.approx(0.6) and sure.observed == Proportion(30, 30)
    judged = {target.statement: target.judged for target in summarise("", [marked] * 100).targets}
    assert judged["names stated at 50 to 80 % that are true"] == "no"
    assert judged["names stated at 99 to 100 % that are true"] == "yes"
    assert not any("that are true" in target.statement for target in summarise("", [marked] * 19).targets)


@pytest.mark.parametrize(
    ("case", "sets", "collection"),
    [
        (single(), [["end_stop"], ["coulomb_friction"]], (2, True)),
        (single(), [["end_stop"]], (1, False)),
        (single(), [], None),
        (replace(single(), effects=()), [["end_stop"]], (1, False)),
    ],
)
def test_the_stated_collection_of_sets_holds_the_truth_or_not(case: Case, sets: list[Any], collection: Any) -> None:
    given = answer("missing_physics", "end_stop", sets=[{"effects": names, "probability": 0.5} for names in sets])
    assert mark(case, given).collection == collection
