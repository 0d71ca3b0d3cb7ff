"""How far a nominal value is believed decides no physics."""

from __future__ import annotations

import pytest
from made import recorded

from eha_core.diagnosis import diagnose_together
from eha_core.identification.free_parameters import NOMINAL_PRIORS, free_nominal_parameters, not_believed
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.plant import PAPER

RIG = {"damping_coefficient": 20.0 * nominal_values()["damping_coefficient"], "coulomb_friction.force": 200.0}


def test_an_unknown_value_may_go_a_thousandfold():
    name = "damping_coefficient"
    known, unknown = (
        next(one for one in free_nominal_parameters(nominal_values(), "voltage", 0.01, names) if one.name == name)
        for names in ((), (name,))
    )
    assert known.upper / known.reference == pytest.approx(NOMINAL_PRIORS[name].bound_factor)
    assert unknown.upper / unknown.reference == pytest.approx(1000.0)
    assert unknown.prior_deviation > 2.0 * known.prior_deviation
    assert not_believed(known, PAPER.place_rows[name]) == unknown


@pytest.mark.parametrize("unknown", [(), ("damping_coefficient",)], ids=["believed", "said to be unknown"])
def test_damping_far_from_its_guess_is_found_and_the_friction_beside_it(unknown):
    model = NominalModel(nominal_values(), frozenset(unknown))
    found = diagnose_together([recorded(RIG, duration=8.0)], model)
    assert [effect.id for effect in found.effects] == ["coulomb_friction"]
    damping = next(one for one in found.parameters if one.name == "damping_coefficient")
    assert damping.fitted == pytest.approx(RIG["damping_coefficient"], rel=0.02)
    assert not damping.at_bound
    assert found.explained.complete
    released = [step for step in found.trace if step.step == "without prior bounds"]
    assert bool(released) != bool(unknown)
