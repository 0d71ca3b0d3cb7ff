"""Windows simulated in lock-step are those that one set after another would give."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from made import recorded

from eha_core.identification.free_parameters import FreeParameter
from eha_core.identification.observation import observe
from eha_core.identification.parallel import side_by_side
from eha_core.identification.problem import STATE_STEP, Problem, changes, linearise, whole
from eha_core.identification.segments import cut
from eha_core.identification.shooting import Shooting
from eha_core.parameters import nominal_values
from eha_core.plant import Plant


@pytest.fixture(scope="module")
def shooting() -> Shooting:
    """Three seconds in windows, the internal leakage changed on purpose in the last of them."""
    made = cut(observe(recorded({"coulomb_friction.force": 200.0}, duration=3.0)), nominal_values())
    leakage = made.leakage.copy()
    leakage[-1] = 3e-11
    return replace(made, leakage=leakage)


def points(shooting: Shooting) -> list[tuple[dict[str, float], np.ndarray]]:
    """Effects with states of their own among them, some in a part of the record only."""
    changes_of = [
        {}, {"coulomb_friction.force": 210.0}, {"spool_hysteresis.half_width": 1e-4, "moving_mass": 12.0},
        {"position_sensor_lag.time_constant": 0.01, "supply_pressure_droop.resistance": 3e10},
        {"pressure_sensor_lag.time_constant_a": 0.02, "pressure_sensor_lag.time_constant_b": 0.01},
        {"presliding_friction.force": 150.0, "presliding_friction.static_force": 200.0, "effects_from": 1.234},
        {"position_sensor_backlash.half_width": 1e-4, "effects_until": 0.777},
        {"coulomb_friction.force": 210.0, "coulomb_friction.acts_from": 0.888, "coulomb_friction.acts_until": 2.3,
         "position_sensor_lag.time_constant": 0.01, "position_sensor_lag.acts_from": 1.111},
    ]  # fmt: skip
    sets = [nominal_values() | change for change in changes_of]
    return [(values, shooting.initial_states + k * STATE_STEP) for k, values in enumerate(sets)]


def test_rows_and_ends_are_those_of_each_set_alone(shooting: Shooting) -> None:
    sets = points(shooting)
    rows, ends = shooting.simulate_many(sets)
    for lane, (values, states) in enumerate(sets):
        expected_rows, expected_ends = shooting.simulate(values, states)
        assert np.ascontiguousarray(rows[:, :, lane]).tobytes() == expected_rows.tobytes()
        assert np.ascontiguousarray(ends[:, :, lane]).tobytes() == expected_ends.tobytes()


def test_windows_are_a_plant_that_is_placed_anew_at_each(shooting: Shooting) -> None:
    """Effects begin and cease inside windows and at their edges; the leakage changes with the last one."""
    edge = float(shooting.edges[1]) * shooting.step_size
    acting = {
        "coulomb_friction.force": 180.0, "coulomb_friction.acts_from": 0.4321, "coulomb_friction.acts_until": 2.5,
        "constant_load.force": 90.0, "constant_load.acts_from": edge, "valve_deadband.half_width": 1e-4,
    }  # fmt: skip
    voltages = shooting.inputs[0].copy()
    voltages[0] = 0.0  # a plant begins with its valve at rest
    given = replace(shooting, inputs=voltages[None])
    rows, ends = given.simulate(nominal_values() | acting, given.initial_states, full=True)
    plant = Plant(acting, given.step_size)
    leakage = plant.parameters["internal_leakage"]
    for window, (first, last) in enumerate(pairwise(given.edges.tolist())):
        plant.set_parameters({"internal_leakage": leakage + given.leakage[window]})
        plant.place(*given.initial_states[window])
        expected = plant.run(voltages[first:last], given.every).values
        assert np.array_equal(rows[first // given.every : last // given.every], expected)
        state = plant.state
        assert tuple(ends[window]) == (state.position, state.velocity, state.pressure_a, state.pressure_b)


def test_a_late_sensor_begins_each_window_from_what_it_showed(shooting: Shooting) -> None:
    """So late that it shows next to nothing of what the pistons do within a window."""
    late = {"pressure_sensor_lag.time_constant_b": 10.0, "position_sensor_lag.time_constant": 10.0}
    elsewhere = shooting.initial_states + [0.0, 0.0, 2e6, -2e6]
    (rows, _), (many, _) = (
        shooting.simulate(nominal_values() | late, elsewhere),
        shooting.simulate_many([(nominal_values() | late, elsewhere)]),
    )
    first = shooting.edges[:-1] // shooting.every
    for found in (rows[first], many[first, :, 0]):
        assert found[:, 0] == pytest.approx(shooting.initial_states[:, 0], abs=1e-6)
        assert found[:, 3] == pytest.approx(shooting.initial_states[:, 3], abs=1e4)
        assert np.all(np.abs(found[:, 2] - shooting.initial_states[:, 2]) > 1e5)


def test_pistons_driven_by_force_too() -> None:
    recording = recorded({}, duration=3.0, channels=("position", "pressure_a", "pressure_b"))
    driven = cut(observe(recording), nominal_values())
    assert driven.drive == "pressures"
    sets = points(driven)
    rows, _ = driven.simulate_many(sets)
    for lane, (values, states) in enumerate(sets):
        assert np.ascontiguousarray(rows[:, :, lane]).tobytes() == driven.simulate(values, states)[0].tobytes()


@pytest.mark.parametrize("jobs", [1, 2])
def test_changes_are_those_of_simulations_one_by_one(shooting: Shooting, jobs: int) -> None:
    problem = Problem(shooting, np.array([0, 2]))
    base, *moved = points(shooting) * 4
    moves = np.linspace(0.5, 2.0, len(moved))
    with side_by_side(jobs):
        columns, ends = changes(problem, base, moved, moves.tolist())
    coarse = problem.slopes
    rows_before, ends_before = coarse.simulate(*base)
    for k, (point, move) in enumerate(zip(moved, moves, strict=True)):
        rows, after = coarse.simulate(*point)
        expected = problem.flat(coarse.sample((rows - rows_before) / move))
        assert np.array_equal(columns[:, k], expected)
        assert np.array_equal(ends[:, :, k], (after - ends_before) / move)


def test_nothing_free_but_the_starts(shooting: Shooting) -> None:
    linear = linearise(whole(shooting), nominal_values(), (), np.zeros(0), shooting.initial_states)
    assert linear.by_parameter.shape == (len(linear.residual), 0)
    assert linear.by_state.shape == (len(linear.residual), 4)
    assert np.any(linear.by_state != 0.0)


def test_a_step_is_taken_inwards_at_a_bound(shooting: Shooting) -> None:
    values = nominal_values() | {"moving_mass": 12.0}
    at_bound = FreeParameter("moving_mass", 9.0, False, 1.0, 1.0, 1.0, 12.0)
    inside = replace(at_bound, upper=13.0)
    slopes = [
        linearise(whole(shooting), values, (one,), np.array([3.0]), shooting.initial_states).by_parameter[:, 0]
        for one in (at_bound, inside)
    ]
    assert np.linalg.norm(slopes[0]) > 0.0
    assert np.linalg.norm(slopes[0] - slopes[1]) < 0.02 * np.linalg.norm(slopes[1])
