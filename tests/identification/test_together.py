"""Several recordings of one rig are fitted as one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis import diagnose_together
from eha_core.errors import RecordingError
from eha_core.identification.fit import fit
from eha_core.identification.free_parameters import free_nominal_parameters
from eha_core.identification.observation import observe
from eha_core.identification.problem import changes, residuals, whole
from eha_core.identification.segments import cut
from eha_core.identification.together import cut_together, fit_alone, recording_alone
from eha_core.identification.validate import split
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values

FIRST = observe(recorded({"coulomb_friction.force": 200.0}, seed=2, duration=3.0))
SECOND = observe(recorded({"constant_load.force": 150.0}, seed=3, duration=4.0, rate=250.0))
BOTH = cut_together([FIRST, SECOND], nominal_values())
VALUES = nominal_values() | {
    "coulomb_friction.force": 180.0,
    "valve_time_delay.delay": 0.004,
    "spool_hysteresis.half_width": 1e-4,
    "effects_from": 0.7,
    "effects_until": 2.4,
}


def test_each_recording_is_simulated_as_it_is_alone():
    rows, ends = BOTH.simulate(VALUES, BOTH.initial_states)
    sampled = BOTH.sample(rows)
    place = 0
    for number, observation in enumerate((FIRST, SECOND), 1):
        alone = cut(observation, nominal_values(), every=BOTH.every)
        its_rows, its_ends = alone.simulate(VALUES, alone.initial_states)
        windows = BOTH.recordings[number - 1]
        np.testing.assert_array_equal(ends[windows.start : windows.stop], its_ends)
        for values in alone.sample(its_rows):
            np.testing.assert_array_equal(sampled[place], values)
            place += 1
    assert place == len(BOTH.samplings) == 6


def test_lock_step_gives_the_same_with_values_of_their_own():
    sets = [(VALUES | {"supply_pressure@2": 15e6, "constant_load.force@2": load}, BOTH.initial_states)
            for load in (0.0, 200.0)]  # fmt: skip
    rows, ends = BOTH.simulate_many(sets)
    for lane, (values, states) in enumerate(sets):
        its_rows, its_ends = BOTH.simulate(values, states)
        np.testing.assert_array_equal(rows[:, :, lane], its_rows)
        np.testing.assert_array_equal(ends[:, :, lane], its_ends)


def test_a_value_of_the_second_recording_changes_nothing_in_the_first():
    problem = whole(BOTH)
    base = (VALUES, BOTH.initial_states)
    columns, _ = changes(problem, base, [(VALUES | {"constant_load.force@2": 100.0}, BOTH.initial_states)])
    windows = problem.order[1]
    assert np.all(columns[windows < BOTH.recordings[1].start] == 0.0)
    assert np.max(np.abs(columns[windows >= BOTH.recordings[1].start])) > 1.0


def test_no_continuity_is_asked_for_from_one_recording_to_the_next():
    links = whole(BOTH).links().tolist()
    assert links == [0, 1, 3, 4, 5]


def test_a_recording_taken_out_is_what_was_put_in():
    for number, observation in enumerate((FIRST, SECOND), 1):
        alone, put_in = recording_alone(BOTH, number), cut(observation, nominal_values(), every=BOTH.every)
        assert alone.names == put_in.names
        np.testing.assert_array_equal(alone.edges, put_in.edges)
        np.testing.assert_array_equal(alone.inputs, put_in.inputs)
        for one, other in zip(alone.samplings, put_in.samplings, strict=True):
            np.testing.assert_array_equal(one.row, other.row)
            np.testing.assert_array_equal(one.window, other.window)
            np.testing.assert_array_equal(one.values, other.values)


def test_a_fit_of_both_has_one_value_where_none_is_marked_and_two_where_it_is():
    rigs = [{"supply_pressure": pressure, "damping_coefficient": 1300.0} for pressure in (19e6, 22e6)]
    seen = [observe(recorded(rig, seed=seed, duration=5.0)) for seed, rig in enumerate(rigs, 7)]
    marked = ("supply_pressure",)
    shooting = cut_together(seen, nominal_values(), per_recording=marked)
    free = free_nominal_parameters(nominal_values(), "voltage", 0.01)
    found = fit(whole(shooting), nominal_values(), free, iterations=20)
    assert found.values["supply_pressure"] == pytest.approx(19e6, rel=0.01)
    assert found.values["supply_pressure@2"] == pytest.approx(22e6, rel=0.01)
    assert found.values["damping_coefficient"] == pytest.approx(1300.0, rel=0.02)
    assert "damping_coefficient@2" not in found.values
    second = fit_alone(shooting, found, 2)
    assert second.values["supply_pressure"] == found.values["supply_pressure@2"]
    alone = recording_alone(shooting, 2)
    rows, _ = alone.simulate(second.values, second.states)
    for one, other in zip(residuals(alone, rows), second.residuals, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


def test_windows_of_each_recording_are_held_out():
    assert split(BOTH)[1].windows.tolist() == [1, 4]
    beyond_the_first = split(BOTH, [3.5])[1]
    assert beyond_the_first.windows.tolist() == [1, 4]
    in_both = split(BOTH, [2.5])[1]
    assert in_both.windows.tolist() == list(range(7))  # no window is left that an instant does not touch


def test_recordings_driven_by_different_channels_are_refused():
    by_pressures = recorded({}, duration=3.0, channels=("position", "pressure_a", "pressure_b"))
    with pytest.raises(RecordingError, match="driven by its pressures"):
        diagnose_together([recorded({}, duration=3.0), by_pressures], nominal_values())


def test_two_recordings_of_friction_that_acts_for_a_while_name_it_together():
    rig = {"coulomb_friction.force": 250.0, "effects_from": 2.5, "effects_until": 5.25}
    both = [recorded(rig, seed=seed, duration=8.0, rate=250.0) for seed in (5, 6)]
    found = diagnose_together(both, nominal_values())
    assert found.verdict == "missing_physics"
    (effect,) = found.effects
    assert effect.id == "coulomb_friction"
    assert effect.active == pytest.approx((2.5, 5.25), abs=0.01)


def test_a_load_of_its_own_in_each_recording_is_found_and_a_third_is_predicted():
    loads = (300.0, -200.0)
    rig = {"coulomb_friction.force": 120.0}
    both = [recorded(rig | {"constant_load.force": load}, seed=seed, duration=6.0, rate=250.0)
            for seed, load in enumerate(loads, 5)]  # fmt: skip
    model = NominalModel(nominal_values(), per_recording=("constant_load.force",))
    third = recorded(rig | {"constant_load.force": 50.0}, seed=9, duration=6.0, rate=250.0)
    found = diagnose_together(both, model, tests=[third])
    assert [effect.id for effect in found.effects] == ["constant_load", "coulomb_friction"]
    assert [one.own_values["constant_load.force"] for one in found.together] == pytest.approx(loads, rel=0.05)
    friction = found.effects[1].parameters["force"]
    assert friction.value == pytest.approx(120.0, abs=4.0 * friction.std)
    tested = found.tests[0].prediction
    assert tested["augmented"]["position"].ahead[0.25] < 0.5 * tested["recalibrated"]["position"].ahead[0.25]


def test_what_begins_anew_after_a_lost_command_does_so_among_several() -> None:
    """The second recording lost its command from 1.2 s to 1.5 s: no link leads into that span or out of it."""
    torn = replace(SECOND, undriven=((1.2, 1.6),))
    shooting = cut_together([FIRST, torn], nominal_values())
    begins = [float(shooting.local_edges[window, 0]) for window in shooting.restarts]
    assert begins == pytest.approx([1.2, 1.6])
    first = shooting.first_windows[1]
    assert all(window > first for window in shooting.restarts)
    assert not np.isin(np.array(shooting.restarts) - 1, whole(shooting).links()).any()
    assert recording_alone(shooting, 2).restarts == cut(torn, nominal_values(), every=shooting.every).restarts
    assert recording_alone(shooting, 1).restarts == ()
