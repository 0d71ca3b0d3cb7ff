"""The summary claims no more than the recording tells."""

from __future__ import annotations

import pytest
from made import explanation

from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.result import Explained, NamedEffect
from eha_core.diagnosis.sets.comparison import Entry
from eha_core.diagnosis.summary import kind_alone, summary
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
    assert kind_alone(decision(winner, *rivals)) == kind


def test_the_kind_is_claimed_and_not_the_law():
    friction = NamedEffect("coulomb_friction", "force", "", {}, 100.0, "the seals rub: 1.9 kN", kind="dry friction")
    said = summary(decision(("coulomb_friction",), ("stribeck_friction",)), (friction,), None, Explained(1.0, {}, True))
    assert said.startswith("Physics is missing: dry friction; most simply, the seals rub: 1.9 kN.")
    assert "Its law cannot be told from this recording: coulomb_friction and stribeck_friction explain it alike" in said
