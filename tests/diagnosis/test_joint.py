"""Recordings of one rig are judged together."""

import pytest
from made import recorded
from test_experiment import explanation

from eha_core.diagnosis import diagnose_together
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.joint import joint_score
from eha_core.diagnosis.tournament import Entry, Tournament
from eha_core.effects import effects
from eha_core.parameters import nominal_values

FIT = explanation({})
LAWS = {effect.id: effect for effect in effects()}
COULOMB, STRIBECK = (NOTHING.with_effects([LAWS[name]]) for name in ("coulomb_friction", "stribeck_friction"))


def seen_in(coulomb, stribeck):
    """A recording in which each law gained so much, and paid 10 for each of its one and three parameters."""
    entries = (
        Entry(COULOMB, FIT, coulomb - 10.0, 10.0),
        Entry(STRIBECK, FIT, stribeck - 30.0, 30.0),
    )
    return Tournament(Entry(NOTHING, FIT, 0.0), entries, (), 1.0)


def test_a_law_pays_for_its_parameters_once():
    both = [seen_in(500.0, 540.0), seen_in(200.0, 200.0)]
    assert joint_score(both, COULOMB) == pytest.approx(690.0)
    assert joint_score(both, STRIBECK) == pytest.approx(710.0)
    assert joint_score(both[:1], STRIBECK) == pytest.approx(510.0)


def test_an_effect_that_acts_for_a_while_is_another_hypothesis_than_one_that_always_does():
    always = Entry(COULOMB, FIT, 100.0, 10.0)
    for_a_while = Entry(NOTHING.with_effects([LAWS["coulomb_friction"]], limited=True), FIT, 900.0, 30.0)
    each = Tournament(Entry(NOTHING, FIT, 0.0), (for_a_while, always), (), 1.0)
    assert joint_score([each, each], COULOMB) == pytest.approx(210.0)
    assert joint_score([each, each], for_a_while.hypothesis) == pytest.approx(1830.0)


@pytest.mark.timeout(400)  # two diagnoses and one more for both
def test_two_recordings_of_friction_that_acts_for_a_while_name_it_together():
    rig = {"coulomb_friction.force": 250.0, "effects_from": 2.5, "effects_until": 5.25}
    both = [recorded(rig, seed=seed, duration=8.0, rate=250.0) for seed in (5, 6)]
    found = diagnose_together(both, nominal_values())
    assert found.verdict == "missing_physics"
    (effect,) = found.effects
    assert effect.id == "coulomb_friction"
    assert effect.active == pytest.approx((2.5, 5.25), abs=0.01)
