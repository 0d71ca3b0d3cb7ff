"""The end of a search: what a member is required to explain, and what is dropped and what stays."""

from dataclasses import replace

import pytest
from made import LAWS, bench, explanation

from eha_core.diagnosis import criteria
from eha_core.diagnosis.calibrate import is_at_noise
from eha_core.diagnosis.criteria import CHANCE, CLEARLY, UNLIKELY
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search.finish import (
    as_large,
    converge,
    finish,
    from_nominal_values,
    in_a_members_place,
    meet,
    of_simpler_form,
    predicted_costs,
    refit_nominal,
    required_of,
    rivals,
)
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.parameters import nominal_values

PLANTED = {"constant_load.force": 60.0, "valve_deadband.half_width": 2e-5}
COUNT = 20_000
MEMBERS = {one.id: one for one in NOTHING.with_effects(LAWS.values()).members}
LOAD, SPRING, DEADBAND, FRICTION, AIR, SCALE = (
    MEMBERS[one]
    for one in (
        "constant_load", "hardening_spring", "valve_deadband", "presliding_friction", "entrained_air",
        "position_sensor_scale",
    )
)  # fmt: skip


def fit_that_leaves(times_noise):
    left = times_noise * COUNT
    return replace(explanation({}), data=left, objective=left, count=COUNT)


def pool_of(nominal_leaves):
    return Pool(None, (), Trace(), {NOTHING: fit_that_leaves(nominal_leaves)})


def by_chance(at, samples=criteria.OF_SAMPLES):
    return max(1.0, at.data / at.count) * (criteria.CHANCE + samples * COUNT)


def test_what_is_required_of_a_member_rises_with_what_is_left():
    pool, costs = pool_of(1e3), dict.fromkeys((LOAD, SPRING), 1e5)
    required = [required_of(pool, SPRING, costs, fit_that_leaves(left)) for left in (1.0, 1.1, 1.5, 2.0, 3.0, 5.0)]
    assert required == sorted(required) and len(set(required)) == len(required)
    ratio = criteria.CONVINCING / (1.0 - criteria.CONVINCING)
    assert required[4] == pytest.approx(ratio * (2.0 - criteria.NOISE_KNOWN) * COUNT)
    assert required[0] < 0.02 * required[4]


def test_what_may_pass_for_noise_asks_for_no_more_than_chance_does():
    quiet = fit_that_leaves(1.0 + 0.9 * criteria.NOISE_KNOWN)
    found = required_of(pool_of(1e3), SPRING, dict.fromkeys((LOAD, SPRING), 1e5), quiet)
    assert found == pytest.approx(by_chance(quiet))


def test_beside_a_law_of_several_forms_a_small_loss_must_be_larger_by_the_curvature():
    quiet, least = fit_that_leaves(1.0), criteria.CHANCE + criteria.OF_SAMPLES * COUNT
    pool = pool_of(1.0)  # nothing is explained, so that no form leaves anything
    for cost, samples in ((1.01, criteria.OF_SAMPLES), (0.99, criteria.OF_SAMPLES_BESIDE_A_FORM)):
        costs = dict.fromkeys((LOAD, SPRING, DEADBAND), cost * least)
        assert DEADBAND.effect.approximate and not LOAD.effect.approximate
        assert required_of(pool, SPRING, costs, quiet) == pytest.approx(by_chance(quiet, samples))
    assert required_of(pool, SPRING, dict.fromkeys((LOAD, SPRING), 0.99 * least), quiet) == pytest.approx(least)


def test_a_laws_form_leaves_something_for_what_acts_in_the_same_balance():
    quiet, pool = fit_that_leaves(1.0), pool_of(1e3)
    costs = dict.fromkeys((FRICTION, AIR, LOAD, SCALE), 1e5)
    left = {member: required_of(pool, member, costs, quiet) - by_chance(quiet) for member in costs}
    assert left[LOAD] == pytest.approx(criteria.OF_ITS_FORM * 1e5)  # the friction's form; air acts on the oil's flow
    assert left[AIR] == left[FRICTION] == pytest.approx(0.0)
    assert left[SCALE] == pytest.approx(criteria.OF_ITS_FORM * 2e5)


def test_a_form_leaves_a_share_of_what_the_whole_set_explains_at_most():
    """Members that counterbalance each other cost more, each, than all explain together."""
    quiet, costs = fit_that_leaves(1.0), {FRICTION: 1e7, LOAD: 1e7}
    found = required_of(pool_of(3.0), LOAD, costs, quiet) - by_chance(quiet)
    assert found == pytest.approx(criteria.OF_ITS_FORM * 2.0 * COUNT)


def test_forces_meet_forces_and_flows_meet_flows_and_a_sensor_shows_both():
    assert meet(LOAD, FRICTION) and meet(AIR, DEADBAND)
    assert not meet(LOAD, AIR) and not meet(DEADBAND, FRICTION)
    assert meet(SCALE, LOAD) and meet(DEADBAND, SCALE)


@pytest.fixture(scope="module")
def rig():
    return bench(PLANTED, duration=4.0)


@pytest.fixture
def pool(rig):
    """The nominal fit alone, in a pool of the test's own."""
    return Pool(rig.pool.problem, rig.pool.plant, Trace(), {NOTHING: rig.pool.found[NOTHING]})


def test_what_explains_nothing_beside_the_others_is_dropped_and_they_stay(rig, pool):
    rig = replace(rig, pool=pool)
    begun = {**PLANTED, "hardening_spring.coefficient": 1e6, "command_delay.delay": 2e-4}
    rig.fitted(begun)
    said: list[str] = []
    whole = rig.set_of("constant_load", "valve_deadband", "hardening_spring", "command_delay")
    best, gains = finish(pool, whole, said.append)
    assert best == rig.set_of("constant_load", "valve_deadband")
    assert set(gains) == set(best.members) and min(gains.values()) > 1.0
    at = pool.found[best]
    for name, value in PLANTED.items():
        assert at.values[name] == pytest.approx(value, abs=max(4.0 * at.deviation(name), 0.01 * value))
    for name in ("hardening_spring", "command_delay"):
        assert any(line.startswith(f"without {name}: ") for line in said)


def test_a_set_with_a_member_that_was_not_needed_is_no_rival_of_another_set(rig, pool):
    rig = replace(rig, pool=pool)
    rig.fitted({**PLANTED, "hardening_spring.coefficient": 1e6})
    whole = rig.set_of("constant_load", "valve_deadband", "hardening_spring")
    needed, _ = finish(pool, whole, lambda _: None)
    assert needed == rig.set_of("constant_load", "valve_deadband")
    rig.fitted({"valve_null_offset.offset": 1e-5})
    _, compared, _ = rivals(pool, rig.set_of("valve_null_offset"), (), lambda _: None)
    assert needed in compared and whole not in compared


def test_every_member_is_tried_if_the_curvature_does_not_need_it_by_far(rig, pool, monkeypatch):
    much, curvature = 0.9 * CLEARLY * CHANCE, "eha_core.diagnosis.search.finish.predicted_costs"
    monkeypatch.setattr(curvature, lambda _, one, __: dict.fromkeys(one.members, much))
    rig = replace(rig, pool=pool)
    rig.fitted({**PLANTED, "hardening_spring.coefficient": 1e6, "command_delay.delay": 2e-4})
    whole = rig.set_of("constant_load", "valve_deadband", "hardening_spring", "command_delay")
    best, gains = finish(pool, whole, lambda _: None)
    assert best == rig.set_of("constant_load", "valve_deadband")
    # each gain is of a fit without the member
    at = pool.found[best]
    for member in best.members:
        lost = pool.found[best.without(member)].objective - at.objective
        assert gains[member] == pytest.approx(lost / required_of(pool, member, dict.fromkeys(best.members, much), at))


def test_what_the_curvature_needs_by_far_costs_no_fit():
    planted = {name: 5.0 * value for name, value in PLANTED.items()}
    rig = bench(planted, duration=4.0)
    rig.fitted({**planted, "hardening_spring.coefficient": 1e6})
    best, gains = finish(rig.pool, rig.set_of("constant_load", "valve_deadband", "hardening_spring"), lambda _: None)
    tried = [step.effects for step in rig.pool.trace.steps if step.step == "without a member"]
    assert tried == [best.ids] == [("constant_load", "valve_deadband")]
    for member in best.members:  # and a fit without it shows the same
        rest = rig.fitted({name: value for name, value in planted.items() if not name.startswith(member.id)})
        needed = CHANCE + criteria.OF_SAMPLES * rest.count
        assert rest.objective - rig.pool.found[best].objective > CLEARLY * needed and gains[member] > CLEARLY


def test_the_costs_of_members_are_those_of_refits(rig, pool):
    rig = replace(rig, pool=pool)
    both = rig.set_of("constant_load", "valve_deadband", "hardening_spring")
    at = rig.fitted({**PLANTED, "hardening_spring.coefficient": 1e6})
    costs = {member.id: cost for member, cost in predicted_costs(pool, both, at).items()}
    assert costs["hardening_spring"] < 20.0
    assert min(costs["constant_load"], costs["valve_deadband"]) > 1e3
    without = rig.fitted(PLANTED).objective - at.objective
    assert costs["hardening_spring"] == pytest.approx(without, abs=2.0)


def test_of_a_load_against_a_spring_the_offset_that_imitates_it_is_a_rival():
    """Against a stiff spring a load is a position sensor that is off, as long as the stroke's ends are far."""
    spring, load = {"spring_stiffness": 2e4}, {"constant_load.force": 30.0}
    rig = bench(load, spring, duration=4.0)
    rig.fitted(load)
    best, _ = finish(rig.pool, rig.set_of("constant_load"), lambda _: None)
    leading, compared, _ = rivals(rig.pool, best, rig.columns, lambda _: None)
    offset = rig.set_of("position_sensor_offset")
    assert {best, offset} <= set(compared) and leading in (best, offset)
    assert rig.pool.found[offset].objective == pytest.approx(rig.pool.found[best].objective, abs=criteria.TIE)
    assert abs(rig.pool.found[offset].values["position_sensor_offset.offset"]) == pytest.approx(30.0 / 2e4, rel=0.05)
    # a set that holds the best and more is no rival of it
    assert not any(set(best.members) < set(one.members) for one in compared)


def test_a_form_that_contains_the_best_one_comes_as_near_and_does_not_lead():
    friction = {"coulomb_friction.force": 250.0}
    rig = bench(friction, duration=4.0)
    rig.fitted(friction)
    best, _ = finish(rig.pool, rig.set_of("coulomb_friction"), lambda _: None)
    leading, compared, _ = rivals(rig.pool, best, rig.columns, lambda _: None)
    stribeck = rig.set_of("stribeck_friction")
    assert leading == best and stribeck in compared
    assert rig.pool.found[stribeck].objective == pytest.approx(rig.pool.found[best].objective, abs=criteria.TIE)
    # what did not come near is not tried again
    hopeless, fits = set(rig.pool.hopeless), len(rig.pool.trace.steps)
    assert rig.set_of("load_friction") in hopeless and stribeck not in hopeless
    rivals(rig.pool, best, rig.columns, lambda _: None)
    again = {tuple(step.effects) for step in rig.pool.trace.steps[fits:]}
    assert not again & {hypothesis.ids for hypothesis in hopeless}


def test_a_set_left_at_the_noise_after_few_iterations_is_fitted_on_before_it_is_compared():
    spring, load = {"spring_stiffness": 2e4}, {"constant_load.force": 0.6}
    rig = bench(load, spring, duration=12.0)
    rig.fitted(load)
    best, offset = rig.set_of("constant_load"), rig.set_of("position_sensor_offset")
    converge(rig.pool, best)
    at = rig.pool.found[best]
    begun = {**at.values, "constant_load.force": 0.0, "position_sensor_offset.offset": -3e-6}
    left = rig.pool.try_set("left", offset, begun, at.states, 0)
    assert is_at_noise(left) and left.objective > at.objective + criteria.COMPARED_WITHIN
    _, compared, _ = rivals(rig.pool, best, [], lambda _: None)
    assert offset in compared
    assert rig.pool.found[offset].objective == pytest.approx(at.objective, abs=criteria.TIE)


def test_another_form_of_a_law_begins_as_large(rig):
    values = {"stribeck_friction.force": 300.0, "stribeck_friction.static_force": 500.0}
    (coulomb, *_), (stribeck, *_) = (
        [column for column in rig.columns if column.effect.id == name]
        for name in ("coulomb_friction", "stribeck_friction")
    )
    fitted = explanation({**dict(stribeck.values), **values})
    assert as_large(coulomb, MEMBERS["stribeck_friction"], fitted) == {"coulomb_friction.force": pytest.approx(400.0)}
    back = as_large(stribeck, MEMBERS["coulomb_friction"], explanation({"coulomb_friction.force": 120.0}))
    # where the force at rest is that in motion, Stribeck's law is Coulomb's
    assert back["stribeck_friction.force"] == back["stribeck_friction.static_force"] == pytest.approx(120.0)
    assert back["stribeck_friction.stribeck_velocity"] == stribeck.values["stribeck_friction.stribeck_velocity"]


@pytest.mark.parametrize(
    ("best", "other", "leaves", "again"),
    [
        ("coulomb_friction", "stribeck_friction", None, True),
        ("coulomb_friction", "stribeck_friction", 900.0, False),
        ("coulomb_friction", "stribeck_friction", 1100.0, True),
        ("stribeck_friction", "coulomb_friction", 700.0, False),
        ("stribeck_friction", "coulomb_friction", 900.0, True),
    ],
)  # fmt: skip
def test_another_form_is_tried_from_the_best_unless_it_was_fitted_near_it(rig, best, other, leaves, again):
    columns = rig.columns_of(best, other)
    (own,) = {column.effect.id: column for column in columns if column.effect.id == best}.values()
    best, other = rig.set_of(best), rig.set_of(other)
    found = {best: replace(explanation(dict(own.values)), objective=800.0)}
    if leaves:
        found[other] = replace(explanation({}), objective=leaves)
    tried = [hypothesis for hypothesis, _ in in_a_members_place(Pool(None, (), Trace(), found), best, columns, 1000.0)]
    assert tried == ([other] if again else [])


def test_what_was_fitted_to_its_end_is_not_fitted_again(rig, pool):
    rig = replace(rig, pool=pool)
    rig.fitted(PLANTED)
    both = rig.set_of("constant_load", "valve_deadband")
    first = converge(pool, both)
    fits = len(pool.trace.steps)
    assert fits and converge(pool, both) is first and len(pool.trace.steps) == fits
    pool.found[both] = replace(first, objective=first.objective + 1.0)
    converge(pool, both)
    assert len(pool.trace.steps) > fits


@pytest.mark.parametrize(("deviations", "again"), [(0.9 * UNLIKELY, False), (1.1 * UNLIKELY, True)])
def test_a_set_with_an_unlikely_nominal_value_is_fitted_from_the_nominal_ones_too(rig, pool, deviations, again):
    """As one that rests in a minimum to which another set led."""
    both = rig.set_of("constant_load", "valve_deadband")
    replace(rig, pool=pool).fitted(PLANTED)
    at = converge(pool, both)
    fits = len(pool.trace.steps)
    mass = next(one for one in at.free if one.name == "moving_mass")
    far = {**at.values, "moving_mass": mass.value(deviations * mass.prior_deviation)}
    pool.found[both] = replace(at, values=far, objective=2.0 * at.objective)
    from_nominal_values(pool, both)
    assert [step.step for step in pool.trace.steps[fits:]] == (["from nominal values", "converge"] if again else [])
    if again:
        assert pool.found[both].objective == pytest.approx(at.objective, rel=1e-3)
        assert pool.found[both].values["moving_mass"] == pytest.approx(at.values["moving_mass"], rel=0.02)


@pytest.mark.parametrize(("left", "asked"), [(10.0, False), (100.0, True)])
def test_beside_a_form_of_fewer_parameters_one_more_effect_is_looked_for_where_it_explains_less(rig, left, asked):
    """Damping beside Coulomb friction is not taken for Stribeck's curve."""
    best, coulomb = (rig.set_of(form, "turbulent_leakage") for form in ("stribeck_friction", "coulomb_friction"))
    at = fit_that_leaves(1.0)
    found = {best: at, coulomb: replace(at, objective=at.objective + left), rig.set_of("coulomb_friction"): at}
    assert of_simpler_form(Pool(None, (), Trace(), found), best) == ([coulomb] if asked else [])
    assert of_simpler_form(Pool(None, (), Trace(), {coulomb: at, best: replace(at, objective=1e9)}), coulomb) == []


def test_a_nominal_fit_in_a_flat_valley_is_led_out_of_it(rig, pool):
    at = pool.found[NOTHING]
    free = free_nominal_parameters(nominal_values(), "voltage", 0.02)
    assert {one.name for one in at.free} == {one.name for one in free}
    astray = replace(at, values={**at.values, "moving_mass": 3.0 * at.values["moving_mass"]}, objective=1e9)
    again = refit_nominal(pool, astray, [at])
    assert again.objective == pytest.approx(at.objective, rel=1e-2)
    assert refit_nominal(pool, at, []) is at
