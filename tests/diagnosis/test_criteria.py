"""The thresholds that decide what is named: none of them moves unnoticed."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made import LAWS, explanation

from eha_core.diagnosis import criteria
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.expansion import Search, leader, required
from eha_core.diagnosis.search.pool import Pool, Trace

THRESHOLDS = {
    "FAR_FROM_NOISE": 5.0,
    "NEAR_NOISE": 1.03,
    "BLOCK": 20,
    "WHITE": 5.0,
    "OF_EXCESS": 0.01,
    "OF_FRICTION": 0.25,
    "CHANCE": 25.0,
    "CLEARLY": 100.0,
    "CERTAINTY": 0.95,
    "OF_SAMPLES": 0.001,
    "OF_SAMPLES_BESIDE_A_FORM": 0.004,
    "OF_ITS_FORM": 0.0006,
    "NOISE_KNOWN": 0.02,
    "ELSEWHERE": 0.0005,
    "CONVINCING": 0.63,
    "NEXT_TO_NOTHING": 0.15,
    "LEFT_IN_A_CHANNEL": 1.2,
    "UNFITTED": 1.3,
    "LEAST_OF_A_LAW": 0.5,
    "COHERENT": 1.5,
    "ENOUGH": 20.0,
    "TIE": 10.0,
    "ADEQUATE": 1.05,
    "DEAR": 0.03,
    "HELD_OUT": 5.0,
    "ODDS_OF_GAIN": 1.7,
    "MISSED": 0.35,
    "TRUE_EVEN_SO": 0.5,
    "CONTENDING": 20.0,
    "PARTLY": 0.2,
    "NEARLY_ALL": 0.1,
    "ITS_FORM": 0.05,
    "WHATEVER_FORM": 0.005,
    "UNKNOWN_MARGIN": 50.0,
    "LEFT_OVER": 0.05,
    "NOTICEABLE": 4.0,
    "RELEVANT": 0.01,
    "UNLIKELY": 2.0,
    "EXPANSIONS": 3,
    "IDLE": 2,
    "IMPROVES": 0.05,
    "BEAM": 10,
    "BEYOND": 2,
    "OF_SIZE": 4,
    "TRIED": 16,
    "TRIED_AT_THE_NOISE": 4,
    "AT_FIRST": 2,
    "FURTHER": 8,
    "FITTED": 6,
    "ADDED": 2,
    "MOST_TRIED": 12,
    "TO_THE_END": 12,
    "CONVERGED": 20,
    "RELATED": 3.0,
    "SHARES": (1.0, 0.5, 0.25),
    "CARRIED": 2,
    "OUTSTANDING": 1.5,
    "COMPARED_WITHIN": 300.0,
    "IDENTIFIED": 2.0,
    "OF_STATES": 6,
    "ALONE": 16,
    "RELEASED": 4,
    "REACH": 1.0,
    "SAME_NOISE": 0.01,
    "FINER_REACH": 0.2,
    "TO_THE_STEP": 4,
    "FEW_SPANS": 25,
    "MOST_SPANS": 100,
    "HATS": 9,
    "OF_SCALE": 0.1,
    "SMALLEST": 0.03,
    "MOVED": 0.1,
    "MOST_OFF": 0.5,
    "BARE_MENTION": 2.0,
    "PARTS_ASKED": 3,
    "HIGHER_AT_REST": 1.2,
    "LAW_SIZE": 3,
    "ENOUGH_WINDOWS": 6,
    "MOST_OF_AN_EVENT": 0.34,
    "LOUD_WINDOW": 2.0,
    "SLICE": 0.25,
    "LOUD_SLICE": 4.0,
    "SCALED_ALIKE": 3,
    "COMMON_FACTOR": 0.999,
    "NOWHERE_ELSE": 0.8,
    "AT_ALL": 50.0,
    "BEHIND_A_FILTER": 16.0,
    "COMBINED_PRECISION": 4.0,
    "SIMPLE_FORMULA": 0.95,
    "EXPRESSED": 0.9,
    "WORTH_A_FORMULA": 0.5,
    "VIOLATED": 1.5,
    "BETTER_LAW": 0.02,
}


def test_no_threshold_moved():
    assert {name: value for name, value in vars(criteria).items() if name.isupper()} == THRESHOLDS


def test_what_must_be_gained_is_more_than_the_best_of_a_thousand_hypotheses_gains_by_chance():
    generator = np.random.default_rng(1)
    best = np.max(generator.chisquare(1, (2000, 1000)), axis=1)
    assert np.mean(best > criteria.chance_gain(0, 1.0)) < 0.001


def test_what_must_be_gained_rises_with_what_nobody_explains():
    assert criteria.chance_gain(40_000, 3.0) == pytest.approx(3.0 * criteria.chance_gain(40_000, 1.0))
    assert criteria.chance_gain(40_000, 0.5) == criteria.chance_gain(40_000, 1.0)


def leaving(objective: float, count: int = 40_000):
    return replace(explanation({}), data=objective, objective=objective, count=count)


def test_while_a_search_goes_on_a_member_gains_more_than_chance_and_a_share_of_what_is_left():
    assert required(leaving(40_000.0)) == criteria.chance_gain(40_000, 1.0)
    far = 3.0 * 40_000.0
    more = criteria.OF_EXCESS * (far - 40_000.0)
    assert required(leaving(far)) == pytest.approx(criteria.chance_gain(40_000, 3.0) + more)


def pool_of(objectives):
    """A pool of fits of so many effects, each of which leaves so much."""
    named = [effect for effect in LAWS.values() if effect.named and not effect.kind]
    sets = {NOTHING.with_effects(named[:size]): leaving(left) for size, left in objectives.items()}
    without_channels = SimpleNamespace(names=(), samplings=())
    return Pool(SimpleNamespace(shooting=without_channels, used=lambda: None), (), Trace(), sets)


def test_of_sets_the_larger_leads_only_where_its_members_gain_more_than_chance():
    by_chance = criteria.chance_gain(40_000, 1.0)
    for gained, size in ((0.9, 1), (1.1, 2)):
        assert len(leader(pool_of({1: 40_000.0, 2: 40_000.0 - gained * by_chance})).members) == size


def test_a_search_goes_on_from_the_leader_then_from_what_is_related_and_ends_at_the_noise():
    times = criteria.RELATED
    far = pool_of({1: 1e6, 2: 0.95 * times * 1e6, 3: 1.05 * times * 1e6})
    one, two, _ = far.found
    search = Search(far, ())
    assert search.next() == one
    search.expanded[one] = far.found[one].objective
    assert search.next() == two
    search.expanded[two] = far.found[two].objective
    assert search.next() is None
    for left, related in ((0.99, False), (1.01, True)):
        quiet = pool_of({1: left * criteria.NEAR_NOISE * 40_000.0, 2: 1.5 * 40_000.0})
        one, two = quiet.found
        assert Search(quiet, (), expanded={one: quiet.found[one].objective}).next() == (two if related else None)


def test_a_search_goes_on_from_a_leader_again_that_was_fitted_further():
    pool = pool_of({1: 41_000.0})
    (one,) = pool.found
    needed = required(pool.found[one])
    for gained, again in ((0.9, None), (1.1, one)):
        assert Search(pool, (), expanded={one: 41_000.0 + gained * needed}).next() == again


def test_a_fit_may_begin_at_the_whole_way_and_at_parts_of_it():
    assert criteria.SHARES[0] == 1.0 and list(criteria.SHARES) == sorted(criteria.SHARES, reverse=True)
    assert min(criteria.SHARES) > 0.0


def test_fits_of_few_iterations_come_first():
    assert criteria.AT_FIRST < criteria.FURTHER < criteria.TO_THE_END < criteria.CONVERGED
    assert criteria.FITTED <= criteria.TRIED and criteria.TRIED_AT_THE_NOISE <= criteria.TRIED
