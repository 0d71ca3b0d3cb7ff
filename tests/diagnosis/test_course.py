"""A whole search: what is planted is named and nothing else, and its cost is in the trace."""

from dataclasses import replace

import pytest
from made import LAWS, bench, explanation, recorded

from eha_core.diagnosis.calibrate import calibrate
from eha_core.diagnosis.characteristic_scales import characteristic_scales
from eha_core.diagnosis.criteria import NEAR_NOISE
from eha_core.diagnosis.hypothesis import NOTHING
from eha_core.diagnosis.search import course
from eha_core.diagnosis.search.columns import applicable_effects
from eha_core.diagnosis.search.course import Material, ended, find_sets, is_due_to
from eha_core.diagnosis.search.equations import Friction, FrictionStart, friction_of
from eha_core.diagnosis.search.pool import Pool, Trace
from eha_core.identification.fit import fit
from eha_core.identification.observation import observe
from eha_core.identification.parallel import side_by_side
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

PLANTED = {
    "constant_load.force": 300.0,
    "coulomb_friction.force": 200.0,
    "valve_deadband.half_width": 1e-4,
}


def searched(parameters, duration):
    """The calibration of a recording of this plant, and what the search finds in it."""
    observation = observe(recorded(parameters, duration=duration))
    calibration = calibrate([observation], NominalModel(nominal_values()))
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    with side_by_side(2):
        return calibration, *find_sets([observation], calibration, applicable_effects([observation]), scales)


@pytest.fixture(scope="module")
def found():
    return searched({**PLANTED, "moving_mass": 10.0}, 5.0)


def test_three_effects_are_named_with_their_values_and_nothing_else(found):
    _, _, comparison = found
    best = comparison.entries[0]
    assert best.ids == ("constant_load", "coulomb_friction", "valve_deadband")
    assert best.fit.data < NEAR_NOISE * best.fit.count
    for name, value in PLANTED.items():
        assert best.fit.values[name] == pytest.approx(value, abs=max(4.0 * best.fit.deviation(name), 0.01 * value))
    assert best.fit.values["moving_mass"] == pytest.approx(10.0, rel=0.02)
    assert all(entry.score <= best.score for entry in comparison.entries)
    assert best.score == pytest.approx(
        (comparison.nominal.fit.objective - best.fit.objective) / comparison.residual_variance - best.cost
    )


def test_friction_is_named_where_no_noise_hides_what_the_step_of_the_simulation_leaves():
    """What is held of it on the way is no part of the nominal model."""
    observation = observe(recorded({"coulomb_friction.force": 250.0}, duration=4.0, noise=0.0))
    calibration = calibrate([observation], NominalModel(nominal_values()))
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    _, comparison = find_sets([observation], calibration, applicable_effects([observation]), scales)
    assert comparison.entries[0].ids == ("coulomb_friction",)
    assert comparison.nominal.fit.values["coulomb_friction.force"] == 0.0


def test_the_nominal_model_is_told_beside_it_in_the_same_noise(found):
    before, after, comparison = found
    assert comparison.nominal.hypothesis == NOTHING and comparison.nominal.score == 0.0
    assert comparison.nominal.fit.objective > comparison.entries[0].fit.objective
    assert comparison.residual_variance == pytest.approx(1.0, abs=0.03)
    assert after.problem.shooting is after.shooting
    assert after.fitted.values == before.fitted.values
    for sampling in after.shooting.samplings:
        planted = 1e-5 if sampling.column == 0 else 1e4
        assert sampling.noise == pytest.approx(planted, rel=0.05)


def test_each_site_has_what_its_members_explain_and_each_member_a_fit_without_it(found):
    _, _, comparison = found
    best = comparison.entries[0]
    assert set(comparison.site_gains) == {effect.site for effect in best.effects}
    assert all(gain > 1000.0 for gain in comparison.site_gains.values())
    assert all(gain < 100.0 for gain in comparison.left_over.values())
    for hypothesis, result in comparison.smaller.items():
        assert len(hypothesis.members) == len(best.effects) - 1
        assert result.objective > best.fit.objective


def test_every_fit_is_in_the_trace(found):
    _, _, comparison = found
    steps = [step.step for step in comparison.trace]
    assert steps[0] == "nominal" and "converge" in steps
    assert any("expansion" in step for step in steps)
    seconds = [step.cpu_s for step in comparison.trace]
    assert seconds == sorted(seconds)
    assert any(set(step.effects) == {name.partition(".")[0] for name in PLANTED} for step in comparison.trace)
    assert {name for step in comparison.trace for name in step.effects} <= LAWS.keys()


def test_windows_in_which_nothing_is_missing_are_passed_over():
    *_, comparison = searched({"moving_mass": 10.0}, 4.0)
    assert comparison.entries == ()
    steps = [step.step for step in comparison.trace]
    assert steps.count("nominal") == 2 and "longer windows" not in steps


def test_friction_that_drags_for_a_while_is_found_though_the_whole_balance_shows_none():
    planted = {"coulomb_friction.force": 250.0, "coulomb_friction.acts_from": 2.5, "coulomb_friction.acts_until": 4.0}
    observation = observe(recorded(planted, duration=8.0))
    calibration = calibrate([observation], NominalModel(nominal_values()))
    scales = characteristic_scales([observation], calibration.shooting, calibration.fitted)
    effects = applicable_effects([observation])
    assert friction_of([observation], calibration.nominal.values, effects, scales).held is None
    with side_by_side(2):
        _, comparison = find_sets([observation], calibration, effects, scales)
    best = comparison.entries[0]
    assert best.ids == ("coulomb_friction",) and best.hypothesis.limited
    for name, value in planted.items():
        assert best.fit.values[name] == pytest.approx(value, abs=max(4.0 * best.fit.deviation(name), 0.01 * value))


@pytest.mark.parametrize(
    ("planted", "named"),
    [
        ({"command_delay.delay": 6e-3, "moving_mass": 10.0}, "command_delay"),
        ({"leakage_onset.time": 4.87, "leakage_onset.internal_leakage": 3e-10}, "leakage_onset"),
    ],
    ids=["a valve that is slower than anybody believes", "a drift that begins when the leak does"],
)
def test_what_can_be_imitated_is_named_and_not_its_imitation(planted, named):
    *_, comparison = searched(planted, 8.0)
    best = comparison.entries[0]
    assert best.ids == (named,) and not best.hypothesis.limited
    gained = comparison.nominal.fit.objective - best.fit.objective
    assert comparison.site_gains == pytest.approx({best.effects[0].site: gained}, rel=1e-3)
    for name in planted.keys() - {"moving_mass"}:
        assert best.fit.values[name] == pytest.approx(planted[name], abs=4.0 * best.fit.deviation(name))


def test_where_a_value_far_beyond_belief_explains_all_nothing_is_named():
    damped = 20.0 * nominal_values()["damping_coefficient"]
    *_, comparison = searched({"damping_coefficient": damped}, 6.0)
    assert comparison.entries == ()
    assert comparison.nominal.fit.values["damping_coefficient"] == pytest.approx(damped, rel=0.02)


def test_friction_is_released_where_what_is_left_may_be_its_own():
    coulomb = LAWS["coulomb_friction"]
    rig = bench({"coulomb_friction.force": 250.0, "constant_load.force": 100.0}, duration=4.0)
    for force, load, due in ((200.0, 100.0, True), (250.0, 0.0, False), (250.0, 100.0, False)):
        held = FrictionStart(coulomb, {"coulomb_friction.force": force})
        hypothesis = rig.set_of("constant_load") if load else NOTHING
        values = {**nominal_values(), **held.values, "constant_load.force": load}
        rig.pool.found = {hypothesis: fit(rig.pool.problem, values, (), iterations=12)}
        assert is_due_to(Friction(False, held, (held,)), rig.pool) == due


def test_the_end_is_repeated_while_the_comparison_leaves_another_set_in_the_lead(monkeypatch):
    coulomb, stribeck = (NOTHING.with_effects([LAWS[f"{form}_friction"]]) for form in ("coulomb", "stribeck"))
    begun, fitted = [], {coulomb: [1010.0, 1005.0], stribeck: [1006.0]}
    pool = Pool(None, (), Trace(), {coulomb: replace(explanation({}), objective=1010.0)})

    def finish(pool, hypothesis, _):
        begun.append(hypothesis)
        return hypothesis, {}

    def rivals(pool, best, *_):
        """Stribeck's law comes lower at first, and from there Coulomb's again; at last nothing does."""
        other = stribeck if best == coulomb else coulomb
        if len(begun) < 3:
            pool.found[other] = replace(explanation({}), objective=fitted[other].pop())
            return other, [best, other], None
        return best, [best, other], None

    monkeypatch.setattr(course, "finish", finish)
    monkeypatch.setattr(course, "rivals", rivals)
    best, _, compared, _ = ended(pool, Material((), (), (), (), pool.trace, lambda _: None, frozenset()))
    assert begun == [coulomb, stribeck, coulomb]
    assert best == coulomb and compared == [coulomb, stribeck] and pool.found[best].objective == 1005.0
