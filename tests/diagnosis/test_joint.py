"""Recordings of one rig are judged together."""

import pytest
from test_experiment import explanation

from eha_core.diagnosis.joint import joint_score
from eha_core.diagnosis.tournament import Entry, Tournament
from eha_core.effects import effects

FIT = explanation({})
LAWS = {effect.id: effect for effect in effects()}
COULOMB, STRIBECK = ("coulomb_friction",), ("stribeck_friction",)


def seen_in(coulomb, stribeck):
    """A recording in which each law gained so much, and paid 10 for each of its one and three parameters."""
    entries = (
        Entry((LAWS["coulomb_friction"],), FIT, coulomb - 10.0, 10.0),
        Entry((LAWS["stribeck_friction"],), FIT, stribeck - 30.0, 30.0),
    )
    return Tournament(Entry((), FIT, 0.0), entries, (), 1.0)


def test_a_law_pays_for_its_parameters_once():
    both = [seen_in(500.0, 540.0), seen_in(200.0, 200.0)]
    assert joint_score(both, COULOMB) == pytest.approx(690.0)
    assert joint_score(both, STRIBECK) == pytest.approx(710.0)
    assert joint_score(both[:1], STRIBECK) == pytest.approx(510.0)
