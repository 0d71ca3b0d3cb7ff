"""The summary claims no more than the recording tells."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made import explanation

from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.in_words import common_kind, summary
from eha_core.diagnosis.result import CommonScale, Explained, NamedEffect
from eha_core.diagnosis.search.comparison import Entry
from eha_core.diagnosis.verdict import Decision
from eha_core.effects import effects

LAWS = {effect.id: effect for effect in effects()}
FIT = explanation({})


def entry(*names):
    return Entry(NOTHING.with_effects([LAWS[name] for name in names]), FIT, 100.0)


def decision(winner, *rivals):
    return Decision("ambiguous", entry(*winner), tuple((entry(*names), 1.0) for names in rivals), None, None)


@pytest.mark.parametrize(
    ("winner", "rivals", "kind"),
    [
        (("coulomb_friction",), [("stribeck_friction",)], "dry friction"),
        (("coulomb_friction",), [("stribeck_friction",), ("presliding_friction",)], "dry friction"),
        (("constant_load", "coulomb_friction"), [("constant_load", "stribeck_friction")], "dry friction"),
        (("coulomb_friction",), [("valve_deadband",)], ""),
        (("coulomb_friction",), [("stribeck_friction",), ("valve_deadband",)], ""),
        (("constant_load", "coulomb_friction"), [("stribeck_friction", "valve_null_offset")], ""),
        (("constant_load", "coulomb_friction"), [("constant_load",)], ""),
    ],
)
def test_what_differs_in_the_form_of_one_law_alone_is_sure_of_its_kind(winner, rivals, kind):
    assert common_kind(decision(winner, *rivals)) == kind


def test_the_kind_is_claimed_and_not_the_law():
    friction = NamedEffect("coulomb_friction", "force", "", {}, 100.0, "the seals rub: 1.9 kN", kind="dry friction")
    said = summary(decision(("coulomb_friction",), ("stribeck_friction",)), (friction,), None, Explained(1.0, {}, True))
    assert said.startswith("Physics is missing: dry friction; most simply, the seals rub: 1.9 kN.")
    assert "Its law cannot be identified from this recording: " in said
    assert "Coulomb friction and Stribeck friction explain it equally well" in said


def test_a_name_that_is_less_than_sure_has_its_probability():
    friction = NamedEffect("coulomb_friction", "force", "", {}, 100.0, "the seals rub: 1.9 kN", probability=0.57)
    load = replace(friction, id="constant_load", statement="a load pushes", probability=0.96)
    alone = replace(decision(("coulomb_friction", "constant_load")), verdict="missing_physics")
    said = summary(alone, (friction, load), None, Explained(1.0, {}, True))
    assert said == "Physics is missing: the seals rub: 1.9 kN (probability 57 %); and a load pushes."


def test_an_event_is_told_before_its_cause_and_a_common_scale_after_the_verdict():
    friction = NamedEffect("coulomb_friction", "force", "", {}, 100.0, "the seals rub: 1.9 kN")
    alone = replace(decision(("coulomb_friction",)), verdict="missing_physics")
    said = summary(alone, (friction,), None, Explained(1.0, {}, True), (3.0, 5.1))
    assert said.startswith("The nominal model fails only from 3.00 s to 5.10 s: an event on the rig, or a fault of")
    assert said.endswith("Physics is missing: the seals rub: 1.9 kN.")
    nothing = Decision("parameters", Entry(NOTHING, FIT, 0.0), (), None, None)
    clock = CommonScale("clock", 2.01, 0.01, ("moving_mass", "valve_gain", "damping_coefficient"))
    said = summary(nothing, (), None, Explained(1.0, {}, True), scale=clock)
    assert "3 values are off by one factor: the clock of the recording may run 2.01 times as fast" in said


def test_what_is_told_from_one_side_and_what_nothing_explains_is_said():
    friction = NamedEffect("coulomb_friction", "force", "", {}, 100.0, "the seals rub: at least 17 kN")
    alone = replace(decision(("coulomb_friction",)), verdict="missing_physics")
    vague = Explained(1.0, {"position": 1.0}, False, (), True)
    assert summary(alone, (friction,), None, vague).endswith("does not determine how strong the effects are.")
    given = Decision("unknown_physics", Entry(NOTHING, FIT, 0.0), (), None, None, as_given=True)
    assert "better than the nominal one" in summary(given, (), None, vague)
