"""One expansion after the other: what is proposed is fitted, and the search goes on from the best of all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made import bench, bench_of

from eha_core.api import known_model
from eha_core.diagnosis.criteria import EXPANSIONS, FITTED, NEAR_NOISE
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import expansion
from eha_core.diagnosis.search.course import at_the_noise
from eha_core.diagnosis.search.expansion import Search, cost, expand, leader, required, search_sets
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.identification.fit import Ending, exact, fit
from eha_core.identification.observation import observe
from eha_core.identification.problem import objectives_at
from eha_core.identification.short_windows import held
from eha_core.recording import read_recording

BAGS = Path(__file__).resolve().parents[2] / "bags"

PLANTED = {"constant_load.force": 300.0, "valve_deadband.half_width": 1e-4}


@pytest.fixture(scope="module")
def rig():
    return bench(PLANTED, duration=4.0)


def searched(rig, say=lambda _: None) -> Search:
    """A search of the test's own, in which nothing but the nominal equations was fitted."""
    pool = Pool(rig.pool.problem, rig.pool.believed, Trace(), {NOTHING: rig.pool.found[NOTHING]})
    return Search(pool, rig.columns_of("constant_load", "valve_deadband", "command_delay", "turbulent_leakage"), say)


def test_two_effects_are_found_by_one_expansion_and_their_values_too(rig):
    said = []
    search = searched(rig, said.append)
    expand(search, NOTHING, "first")
    best = leader(search.pool)
    assert best == rig.set_of("constant_load", "valve_deadband")
    at = search.pool.found[best]
    assert at.data < NEAR_NOISE * at.count
    for name, value in PLANTED.items():
        assert at.values[name] == pytest.approx(value, abs=max(4.0 * at.deviation(name), 0.01 * value))
    assert len(search.pool.trace.steps) <= FITTED + 1
    assert said == [said[0]] and "constant_load + valve_deadband" in said[0]


def test_no_proposal_is_left_while_it_may_come_below_the_best(rig):
    search = searched(rig)
    expand(search, NOTHING, "first")
    proposed = {hypothesis: at for hypothesis, at in search.pool if hypothesis != NOTHING}
    assert len(proposed) > 1
    assert not any(at.ending is Ending.ITERATIONS for at in proposed.values())


def test_a_search_expands_no_set_twice_and_ends_at_the_noise(rig):
    search = searched(rig)
    best = search_sets(search)
    assert best == rig.set_of("constant_load", "valve_deadband")
    assert search.expanded.keys() == {NOTHING, best}
    assert search.next() is None


def test_a_search_ends_after_a_few_expansions_however_much_each_gains(rig, monkeypatch):
    search, begun = searched(rig), []

    def halved(search, base, step, at=None):
        begun.append(step)
        at = search.pool.found[NOTHING]
        search.pool.keep(NOTHING, replace(at, objective=0.5 * at.objective, data=0.5 * at.data))

    monkeypatch.setattr(expansion, "expand", halved)
    search_sets(search)
    assert begun == ["expansion 1", "expansion 2", "expansion 3"] and len(begun) == EXPANSIONS


def test_on_the_way_to_long_windows_nothing_is_expanded_at_the_noise(rig):
    search = searched(rig)
    search.content = at_the_noise
    assert search_sets(search) == rig.set_of("constant_load", "valve_deadband")
    assert search.expanded.keys() == {NOTHING}


def test_a_set_pays_for_its_size_and_far_from_the_noise_a_member_has_to_gain_more(rig):
    at = rig.pool.found[NOTHING]
    one = rig.set_of("constant_load")
    assert cost(one, at) - cost(NOTHING, at) > 25.0
    assert required(at) > cost(one, at) - cost(NOTHING, at)


def test_near_the_noise_only_what_is_predicted_to_come_nearer_is_fitted_besides(rig, monkeypatch):
    monkeypatch.setattr(expansion, "is_at_noise", lambda _: True)  # then whatever is fitted first is near enough
    search = searched(rig)
    expand(search, NOTHING, "first")
    fitted = [step.effects for step in search.pool.trace.steps if step.step == "first"]
    first = len(fitted[0])
    assert all(len(effects) <= first for effects in fitted)
    assert leader(search.pool) == rig.set_of("constant_load", "valve_deadband")


@pytest.mark.parametrize(
    ("size", "nearer", "tried"), [(2, 1.1, True), (2, 0.9, False), (1, 0.1, True), (1, -0.1, False), (3, 9.9, False)]
)
def test_near_the_noise_a_set_may_leave_more_for_what_it_has_fewer(rig, size, nearer, tried):
    at = rig.pool.found[NOTHING]
    names = ["constant_load", "valve_deadband", "turbulent_leakage"]
    near, other = rig.set_of(*names[:2]), rig.set_of(*names[:size])
    start = expansion._Start(at.objective, at.objective - nearer * required(at), other, {}, at.states)
    assert expansion._contends(start, near, at) == tried


def test_sets_that_keep_a_large_member_are_tried_however_well_the_others_are_predicted():
    """Without a leak that explains nearly all the quadratic model promises thirty times too much."""
    recording = read_recording(BAGS / "rig_five_effects.mcap")
    given = known_model(None, recording).values
    rig = bench_of(observe(recording), given, 0.2)
    pool, leak = replace(rig.pool, believed=held(rig.pool.believed, given), found={}), rig.set_of("external_leakage")
    begun = pool.try_set("nominal", NOTHING, given, None, 8)
    first = rig.columns_of("external_leakage")[0].values
    at = pool.try_set("leak", leak, {**begun.values, **first}, begun.states, 12)
    assert at.objective < 0.2 * begun.objective
    expand(Search(pool, rig.columns), leak, "second")
    best = leader(pool)
    assert {"external_leakage", "valve_deadband"} <= set(best.ids)
    assert pool.found[best].objective < 0.1 * at.objective


def test_the_objective_at_a_point_is_that_of_a_fit_that_does_not_move(rig):
    problem, at = exact(rig.pool.problem), rig.pool.found[NOTHING]
    other = {**at.values, "moving_mass": 1.2 * at.values["moving_mass"]}
    found = objectives_at(problem, [(at.values, at.states), (other, at.states)])
    expected = [fit(problem, values, (), at.states, iterations=0).objective for values in (at.values, other)]
    assert np.allclose(found, expected, rtol=1e-9)
