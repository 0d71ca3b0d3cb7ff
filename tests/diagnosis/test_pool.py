"""What a search keeps of its fits: the best of each set, in one noise, and a trace of all."""

from dataclasses import replace

import numpy as np
import pytest
from made import LAWS, bench

from eha_core.diagnosis.criteria import BLOCK, FAR_FROM_NOISE, NEAR_NOISE, REACH
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import derivatives
from eha_core.diagnosis.search.pool import Pool, Trace, excess_of_block_means
from eha_core.identification.fit import fit
from eha_core.parameters import nominal_values

PLANTED = {"constant_load.force": 300.0, "valve_deadband.half_width": 1e-4}


@pytest.fixture(scope="module")
def rig():
    made = bench(PLANTED, duration=4.0)
    made.fitted(PLANTED)
    return made


@pytest.fixture
def pool(rig):
    """The same fits, in a pool of the test's own."""
    return Pool(rig.pool.problem, rig.pool.plant, Trace(), dict(rig.pool.found))


def test_a_fit_in_another_noise_is_the_same_model(rig, pool):
    both = rig.set_of("constant_load", "valve_deadband")
    best = pool.found[both]
    doubled = [replace(one, noise=0.5 * one.noise) for one in pool.problem.shooting.samplings]
    pool.problem = replace(pool.problem, shooting=replace(pool.problem.shooting, samplings=tuple(doubled)))
    loud = tuple(2.0 * one for one in best.residuals)
    pool.found[both] = replace(best, residuals=loud, data=4.0 * best.data, objective=best.objective + 3.0 * best.data)
    others = {hypothesis: result for hypothesis, result in pool if hypothesis != both}
    pool.measure_noise(both)
    weighed_rightly = replace(pool, problem=rig.pool.problem, found=dict(rig.pool.found))
    weighed_rightly.measure_noise(both)
    for now, then in zip(pool.problem.shooting.samplings, weighed_rightly.problem.shooting.samplings, strict=True):
        assert now.noise == pytest.approx(then.noise, rel=1e-3)
    weighed = pool.found[both]
    anew = fit(pool.problem, best.values, best.free, best.states, iterations=0)
    assert weighed.values == best.values
    assert weighed.objective == pytest.approx(anew.objective, rel=1e-9)
    assert weighed.data == pytest.approx(anew.data, rel=1e-9)
    assert all(pool.found[hypothesis].values == result.values for hypothesis, result in others.items())


def test_what_a_model_leaves_that_is_far_off_is_no_noise(pool):
    before = pool.problem
    far = replace(pool.found[NOTHING], data=1.01 * FAR_FROM_NOISE * pool.found[NOTHING].count)
    pool.found[NOTHING] = far
    pool.measure_noise(NOTHING)
    assert pool.problem is before and pool.found[NOTHING] is far


def test_noise_stays_within_twice_what_the_channels_show_however_often_it_is_measured(rig, pool):
    """What a model that is not far off leaves of a piston that sticks is rough, too."""
    rough = 3.0 * np.random.default_rng(3).standard_normal((3, 100_000))
    for _ in range(4):
        at = pool.found[NOTHING]
        residuals = tuple(row[: len(left)] for row, left in zip(rough, at.residuals, strict=False))
        pool.found[NOTHING] = replace(at, residuals=residuals, data=2.0 * at.count)
        pool.measure_noise(NOTHING)
    for now, then in zip(pool.problem.shooting.samplings, rig.pool.problem.shooting.samplings, strict=True):
        assert now.noise == pytest.approx(2.0 * then.own_noise)


def test_the_best_fit_of_a_set_is_kept_and_every_fit_is_in_the_trace(rig, pool):
    both = rig.set_of("constant_load", "valve_deadband")
    best = pool.found[both]
    far = {**best.values, "constant_load.force": -900.0}
    assert pool.try_set("from afar", both, far, best.states, 0) is best
    assert pool.found[both] is best
    glanced = pool.glance("a glance", rig.set_of("coulomb_friction"), {**best.values, "coulomb_friction.force": 50.0},
                          best.states, 1)  # fmt: skip
    assert rig.set_of("coulomb_friction") not in pool.found
    assert {parameter.name for parameter in glanced.free} == {"coulomb_friction.force"}
    further = pool.go_on("further", both, 2)
    assert further.objective <= best.objective
    steps = [(step.step, tuple(step.effects)) for step in pool.trace.steps]
    assert steps == [("from afar", both.ids), ("a glance", ("coulomb_friction",)), ("further", both.ids)]
    seconds = [step.cpu_s for step in pool.trace.steps]
    assert seconds == sorted(seconds) and seconds[0] > 0.0


def test_a_fit_moves_the_plant_its_members_and_when_a_limited_one_acts(pool):
    limited = NOTHING.with_effects([LAWS["constant_load"]], limited=True)
    values = {**pool.found[NOTHING].values, "constant_load.acts_from": 0.4, "constant_load.acts_until": 2.5}
    free = {parameter.name: parameter for parameter in pool.free(limited, values)}
    plant = {parameter.name for parameter in pool.plant}
    instants = {"constant_load.acts_from", "constant_load.acts_until"}
    assert free.keys() == plant | {"constant_load.force"} | instants
    longest = float(pool.problem.shooting.local_edges.max())
    spans = [(free[name].lower, free[name].upper) for name in sorted(instants)]
    assert spans == [(0.0, pytest.approx(0.4 + REACH)), (pytest.approx(1.5), pytest.approx(min(3.5, longest)))]


def test_about_one_fit_nothing_is_simulated_twice(rig, pool, monkeypatch):
    both = rig.set_of("constant_load", "valve_deadband")
    simulated = []

    def counted(*given):
        simulated.append(len(given[2]))
        return changes(*given)

    changes = derivatives.changes
    monkeypatch.setattr(derivatives, "changes", counted)
    about = pool.about(both, pool.found[both])
    first = about.secants(rig.columns[:3])
    assert pool.about(both, pool.found[both]) is about
    again = about.secants(rig.columns[:3])
    assert simulated == [3] and all(np.array_equal(one, other) for one, other in zip(first[1:], again[1:], strict=True))
    about.secants(rig.columns[3:5])
    assert simulated == [3, 2]
    # another fit, other bounds and another noise are others
    assert pool.about(NOTHING, pool.found[NOTHING]) is not about
    pool.problem = replace(pool.problem)
    assert pool.about(both, pool.found[both]) is not about
    about = pool.about(both, pool.found[both])
    pool.released = frozenset({pool.believed[0].name})
    assert pool.about(both, pool.found[both]) is not about


def test_fits_of_another_pool_are_kept_where_they_are_better(rig, pool):
    both, rest = rig.set_of("constant_load", "valve_deadband"), rig.set_of("constant_load")
    other = pool.fresh()
    assert not other.found and other.trace is pool.trace
    other.keep(rest, replace(pool.found[both], objective=pool.found[both].objective + 1e9))
    pool.found[rest] = pool.found[both]
    other.adopt(pool)
    assert other.found[rest].objective == pool.found[both].objective and other.found.keys() == pool.found.keys()


def test_prior_bounds_come_back_together_where_they_cost_nothing(rig, pool):
    both = rig.set_of("constant_load", "valve_deadband")
    pool.released = frozenset({"moving_mass", "bulk_modulus"})
    believed = {parameter.name: parameter.upper for parameter in pool.believed}
    assert {p.name: p.upper for p in pool.plant if p.upper > believed[p.name]}.keys() == pool.released
    pool.try_set("released", both, pool.found[both].values, pool.found[both].states, 2)
    pool.believe(both)
    assert pool.released == frozenset()
    assert [step.step for step in pool.trace.steps] == ["released", "within a prior bound"]
    assert {p.name: p.upper for p in pool.found[both].free if p.name in believed} == believed


def test_a_prior_bound_that_costs_stays_away():
    damped = 20.0 * nominal_values()["damping_coefficient"]
    rig = bench({"damping_coefficient": damped}, duration=3.0)
    bound = rig.pool.found[NOTHING]
    assert "damping_coefficient" in bound.held_by_belief()
    rig.pool.release(NOTHING)
    assert rig.pool.found[NOTHING].values["damping_coefficient"] == pytest.approx(damped, rel=0.05)
    rig.pool.released |= {"moving_mass"}
    rig.pool.believe(NOTHING)
    assert rig.pool.released == {"damping_coefficient"}
    assert rig.pool.found[NOTHING].objective < bound.objective - 100.0


def test_a_bound_is_released_in_the_nominal_equations_too():
    damped = 20.0 * nominal_values()["damping_coefficient"]
    rig = bench({"damping_coefficient": damped}, duration=3.0)
    load, bound = rig.set_of("constant_load"), rig.pool.found[NOTHING]
    rig.fitted({"constant_load.force": 10.0})
    rig.pool.release(load)
    for hypothesis in (NOTHING, load):
        assert rig.pool.found[hypothesis].objective < bound.objective - 100.0


def test_where_a_member_sticks_derivatives_are_taken_more_finely(rig, pool):
    assert pool.posed(rig.set_of("constant_load")) is pool.problem
    assert pool.posed(rig.set_of("coulomb_friction")).slope_step < pool.problem.slope_step


def test_a_slow_residual_is_not_white(rig, pool):
    """Block averages of white noise are as large as chance makes them; those of a slow sine are its own, by the
    closed form."""
    both, rng = rig.set_of("constant_load", "valve_deadband"), np.random.default_rng(7)
    at = pool.found[both]
    power = 0.1
    white = tuple(rng.standard_normal(len(row)) for row in at.residuals)
    used = pool.problem.used()
    counts = [int(used[sampling.window].sum()) for sampling in pool.problem.shooting.samplings]
    slow = tuple(row + np.sqrt(2.0 * power) * np.sin(0.05 * np.arange(len(row))) for row in white)
    blocks = sum(count // BLOCK for count in counts)
    of_noise, of_sine = (excess_of_block_means(pool.problem, replace(at, residuals=rows)) for rows in (white, slow))
    assert abs(of_noise) < 3.0
    averaged = power * (np.sin(0.025 * BLOCK) / (0.025 * BLOCK)) ** 2
    assert of_sine == pytest.approx(((1.0 + averaged * BLOCK) / (1.0 + power) - 1.0) * np.sqrt(blocks / 2.0), rel=0.2)
    assert excess_of_block_means(pool.problem, replace(at, residuals=slow), pool.problem.shooting.names) == 0.0
    pool.found[both] = replace(at, residuals=slow, data=1.01 * at.count)
    assert not pool.leaves_noise(both)
    pool.found[both] = replace(at, residuals=white, data=at.count)
    assert pool.leaves_noise(both)
    pool.found[both] = replace(at, residuals=white, data=1.01 * NEAR_NOISE * at.count)
    assert not pool.leaves_noise(both)
