"""The probability of a set and of a name, from the scores, what is required, and how the search went."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made import LAWS, explanation

from eha_core.diagnosis.criteria import CERTAINTY, MISSED, ODDS_OF_GAIN, TIE, TRUE_EVEN_SO
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.posterior import missed, probability, probable_sets
from eha_core.diagnosis.search.comparison import Entry, ModelComparison

SIZES = {"coulomb_friction.force": 100.0, "constant_load.force": 50.0, "valve_null_offset.offset": 1e-4}
FIT = explanation(SIZES)


def entry(score: float, *names: str) -> Entry:
    return Entry(NOTHING.with_effects([LAWS[name] for name in names]), FIT, score)


BEST = entry(1000.0, "coulomb_friction", "constant_load")
RIVAL = entry(1000.0 - TIE, "coulomb_friction", "valve_null_offset")
COMPARED = ModelComparison(
    Entry(NOTHING, FIT, 0.0), (BEST, RIVAL), 1.0,
    gain_over_required=dict.fromkeys(BEST.hypothesis.members, 1e6),
)  # fmt: skip


def test_of_two_sets_a_tie_apart_the_better_has_what_counts_as_certain() -> None:
    first, *_ = probable_sets(COMPARED, BEST)
    assert first.effects == BEST.ids
    assert first.probability == pytest.approx(CERTAINTY, abs=1e-6)


def test_a_member_that_gains_just_what_is_required_is_as_probable_as_not() -> None:
    load = next(member for member in BEST.hypothesis.members if member.id == "constant_load")
    weak = replace(COMPARED, entries=(BEST,), gain_over_required={**COMPARED.gain_over_required, load: 1.0})
    sets = probable_sets(weak, BEST)
    assert probability(sets, "constant_load") == pytest.approx(0.5, abs=1e-3)
    assert probability(sets, "coulomb_friction") == pytest.approx(1.0)
    twice = replace(weak, gain_over_required={**weak.gain_over_required, load: 2.0})
    odds = probability(probable_sets(twice, BEST), "constant_load") / (
        1.0 - probability(probable_sets(twice, BEST), "constant_load")
    )
    assert odds == pytest.approx(2.0**ODDS_OF_GAIN, rel=1e-3)


def test_a_search_that_began_anew_leaves_room_for_a_set_that_it_did_not_find() -> None:
    anew = replace(COMPARED, begun_anew=True)
    at_once, after = probable_sets(COMPARED, BEST), probable_sets(anew, BEST)
    assert [each.effects for each in after] == [each.effects for each in at_once]
    assert sum(each.probability for each in after) == pytest.approx(
        (1.0 - MISSED) * sum(each.probability for each in at_once)
    )
    assert missed(COMPARED) == 0.0
    named = probability(after, "coulomb_friction", missed(anew))
    assert named == pytest.approx((1.0 - MISSED) + MISSED * TRUE_EVEN_SO)
    assert probability(after, "thermal_drift", missed(anew)) < named
