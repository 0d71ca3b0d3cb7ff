"""What the conclusion may claim."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from test_experiment import explanation

from eha_core.diagnosis.conclude import _unknown
from eha_core.diagnosis.hypothesis import NOTHING
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
