"""What is left of a response against a fit of the nominal equations to it, and the search's columns against effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tested_rig import at, column_of, measuring

from eha_core.detectability.planned import RigAsModelled
from eha_core.diagnosis.detection.responses import responses
from eha_core.identification.fit import exact, fit


@pytest.fixture(scope="module")
def rig() -> RigAsModelled:
    return at()


SMALL = [
    column_of("coulomb_friction", force=2.0),
    column_of("constant_load", force=1.0),
    column_of("valve_deadband", half_width=3e-7, rounding=6e-6),
    column_of("supply_pressure_droop", resistance=3e8, time_constant=0.05),
    column_of("position_sensor_backlash", half_width=2e-6),
]


@pytest.mark.parametrize("column", SMALL, ids=lambda column: column.effect.id)
def test_what_is_left_is_what_a_fit_of_the_nominal_equations_leaves(rig: RigAsModelled, column: object) -> None:
    """An independent answer: the faulty response simulated, measured without noise, and the rig as modelled fitted."""
    shooting = rig.pool.problem.shooting
    rows, _ = shooting.simulate({**rig.fit.values, **column.values}, rig.fit.states)
    problem = exact(measuring(rig.pool.problem, shooting.sample(rows)))
    fitted = fit(problem, rig.fit.values, rig.pool.plant, rig.fit.states, iterations=20, in_a_row=2)
    assert responses(rig, [column]).left(0) == pytest.approx(fitted.objective, rel=0.05)


def test_held_parameters_leave_more_and_the_effect_itself_explains_all(rig: RigAsModelled) -> None:
    seen = responses(rig, SMALL)
    for place in range(len(SMALL)):
        assert seen.left(place) < seen.energy(place)
        assert seen.left(place, [place]) < 1e-3 * seen.energy(place)
        assert seen.left(place, [(place + 1) % len(SMALL)]) <= seen.left(place) + 1e-9


def test_a_smaller_size_of_a_linear_effect_has_the_square_of_its_energy(rig: RigAsModelled) -> None:
    seen = responses(rig, [column_of("constant_load", force=1.0), column_of("constant_load", force=0.5)])
    assert seen.left(1) == pytest.approx(0.25 * seen.left(0), rel=0.02)


def test_a_scale_of_the_position_is_compensated_and_not_usable(rig: RigAsModelled) -> None:
    seen = responses(rig, [column_of("position_sensor_scale", ratio=0.05), SMALL[0]])
    assert seen.usable.tolist() == [False, True]
    assert "moving_mass" in seen.compensating(0) or "damping_coefficient" in seen.compensating(0)


def test_deviations_are_those_of_a_fit(rig: RigAsModelled) -> None:
    """The coordinate's deviation of each nominal parameter from the covariance of a fit that has nothing to move."""
    fitted = fit(rig.pool.problem, rig.fit.values, rig.pool.plant, rig.fit.states, iterations=1)
    at_states = replace(rig, fit=replace(rig.fit, states=fitted.states))
    found = responses(at_states, ()).deviations()
    for place, parameter in enumerate(fitted.free):
        assert found[parameter.name] == pytest.approx(np.sqrt(fitted.covariance[place, place]), rel=0.1), parameter.name
