"""What the conclusion may claim."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from test_experiment import explanation

from eha_core.diagnosis.conclude import _led_by, _ordered, _unknown
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.result import Location, UnknownLaw
from eha_core.diagnosis.unknown import Recovery
from eha_core.effects import effects

CURVE = next(effect for effect in effects() if effect.id == "recovered_force")


@pytest.mark.parametrize(("share", "told"), [(0.3, False), (0.8, True)])
def test_a_function_that_leaves_more_than_it_explains_is_no_law(share, told):
    speeds = np.linspace(-0.2, 0.2, 12)
    knots = tuple((float(speed), 3000.0 * float(speed)) for speed in speeds)
    evidence = SimpleNamespace(
        decision=SimpleNamespace(verdict="unknown_physics"),
        balances=(),
        recovery=Recovery(CURVE, "velocity", NOTHING.with_effects([CURVE]), explanation({}), 500.0, share, knots),
    )
    law = _unknown(evidence)
    assert (law is not None) == told
    if law is not None:
        assert law.function_of == "velocity"
        assert law.expression == "3e3 v [N], v in m/s"


def test_a_curve_that_no_expression_fits_is_told_by_its_knots_alone():
    speeds = np.linspace(-0.2, 0.2, 12)
    forces = 300.0 * np.random.default_rng(6).standard_normal(12)
    knots = tuple(zip(speeds.tolist(), forces.tolist(), strict=True))
    evidence = SimpleNamespace(
        decision=SimpleNamespace(verdict="unknown_physics"),
        balances=(),
        recovery=Recovery(CURVE, "velocity", NOTHING.with_effects([CURVE]), explanation({}), 500.0, 0.8, knots),
    )
    law = _unknown(evidence)
    assert law is not None and law.expression == ""
    assert (law.site, law.function_of, law.r_squared, law.samples) == ("force", "velocity", 0.8, knots)


def test_the_site_of_the_named_effect_leads_and_takes_its_span():
    named, other, least = (Location(site, share, "everywhere", ((0.0, 9.0),), "") for site, share in (
        ("force", 0.2), ("chamber", 0.7), ("sensor", 0.1)
    ))  # fmt: skip
    friction = next(effect for effect in effects() if effect.id == "coulomb_friction")
    assert friction.site == "force"
    always = _ordered((least, other, named), SimpleNamespace(effects=(friction,), span=None))
    assert always == (named, other, least)
    first, *rest = _ordered((least, other, named), SimpleNamespace(effects=(friction,), span=(2.0, 5.0)))
    assert (first.site, first.share, first.when) == ("force", 0.2, ((2.0, 5.0),))
    assert rest == [other, least]


def test_the_site_of_a_law_leads_and_is_told_once():
    seen = (Location("chamber", 0.6, "at large pressures", ((1.0, 2.0),), ""), Location("force", 0.3, "", (), ""))
    first, *rest = _led_by(UnknownLaw("force", "velocity", "3e3 v", 0.84, ()), seen)
    assert (first.site, first.share, first.where, first.when) == ("force", 0.84, "at large pressures", ((1.0, 2.0),))
    assert first.statement.startswith("84% of what is missing") and "velocity" in first.statement
    assert rest == [seen[0]]
    (alone,) = _led_by(UnknownLaw("force", "velocity", "3e3 v", 0.84, ()), ())
    assert (alone.where, alone.when) == ("all over the states that were visited", ())
