"""The budget against simulations made one by one, and its intervals against draws of the values."""

from __future__ import annotations

import numpy as np
import pytest
from rigs import FRICTION, LEAKAGE, MASS, document

from eha_core.error_budget import Budget, Task, error_budget, rig_from_changes, rig_from_document, shares
from eha_core.error_budget.rig import PARAMETERS
from eha_core.error_budget.shares import SURE
from eha_core.parameters import catalogue, nominal_values
from eha_core.plant import PAPER
from eha_core.signals import from_text

TASK = Task(from_text("sine:amplitude=0.01,frequency=2"), "cascade", duration=1.0, skip=0.5)


def rmse(**rig: float) -> float:
    values = nominal_values() | {name.replace("__", "."): value for name, value in rig.items()}
    return float(TASK.rmse([values], nominal_values(), PAPER)[0])


@pytest.fixture(scope="module")
def budget() -> Budget:
    return error_budget(rig_from_document(document(), "made"), TASK)


def test_the_shares_and_the_model_s_own_error_add_up_to_today_s(budget: Budget) -> None:
    total = budget.modelled.value + sum(row.share.value for row in budget.shares)
    assert total == pytest.approx(budget.today.value, abs=1e-9 * budget.today.value)
    assert budget.modelled.value == rmse() and budget.modelled.reach == 0.0
    assert budget.today.value == rmse(coulomb_friction__force=250.0, internal_leakage=1e-10, moving_mass=11.0)


def test_a_repair_gains_what_the_simulation_without_it_has_less(budget: Budget) -> None:
    gains = {row.name: row.gain.value for row in budget.shares}
    without = rmse(internal_leakage=1e-10, moving_mass=11.0)
    assert gains["coulomb_friction"] == pytest.approx(budget.today.value - without, rel=1e-12)
    first, last = budget.order
    assert gains[first.name] == max(gains["coulomb_friction"], gains[LEAKAGE])
    assert first.rmse.value == pytest.approx(budget.today.value - gains[first.name], rel=1e-12)
    assert last.rmse.value == budget.repaired.value == rmse(moving_mass=11.0)


def test_two_effects_by_hand() -> None:
    made = error_budget(rig_from_changes({FRICTION: 250.0, LEAKAGE: 1e-10}, nominal_values()), TASK)
    none, both = rmse(), rmse(coulomb_friction__force=250.0, internal_leakage=1e-10)
    rubs, leaks = rmse(coulomb_friction__force=250.0), rmse(internal_leakage=1e-10)
    found = {row.name: row.share.value for row in made.shares}
    assert found["coulomb_friction"] == pytest.approx(0.5 * ((rubs - none) + (both - leaks)), rel=1e-12)
    assert found[LEAKAGE] == pytest.approx(0.5 * ((leaks - none) + (both - rubs)), rel=1e-12)
    assert made.subsets == {(): none, ("coulomb_friction",): rubs, (LEAKAGE,): leaks,
                            ("coulomb_friction", LEAKAGE): both}  # fmt: skip


def test_the_intervals_are_those_of_draws_from_the_posterior(budget: Budget) -> None:
    """Normal draws of friction, leakage and mass with their correlation, each rig simulated by itself."""
    rig = rig_from_document(document(), "made")
    scale = np.array(list(rig.deviations.values()))
    draws = np.random.default_rng(3).multivariate_normal(np.zeros(3), rig.correlation * np.outer(scale, scale), 300)
    centre = rig.values(rig.departures)
    sets = [centre | {name: centre[name] + float(move) for name, move in zip(rig.deviations, draw, strict=True)}
            for draw in draws]  # fmt: skip
    today = TASK.rmse(sets, rig.modelled, PAPER)
    assert budget.today.reach == pytest.approx(SURE * np.std(today), rel=0.12)
    gained = today - TASK.rmse([values | {FRICTION: 0.0} for values in sets], rig.modelled, PAPER)
    (gain,) = (row.gain for row in budget.shares if row.name == "coulomb_friction")
    assert gain.reach == pytest.approx(SURE * np.std(gained), rel=0.12)


def test_a_value_is_moved_down_where_its_upper_bound_is_near() -> None:
    """Both secants are of one nearly straight line, so that the intervals are alike; up there is only the bound."""
    upper = catalogue()["coulomb_friction.force"].upper
    made = document(correlation={"names": [FRICTION], "matrix": [[1.0]]})
    made["fitted_values"] = {FRICTION: upper}
    made["parameters"] = []
    made["effects"][0]["parameters"]["force"]["std"] = 1e-3 * upper
    hold = Task(from_text("step:height=0,at=0"), "pid", duration=0.2, skip=0.0)
    rig = rig_from_document(made, "made")
    assert shares._directions(rig) == {FRICTION: -1.0}
    assert shares._moved(rig, {FRICTION: -1.0}) == [{FRICTION: upper - 1e-3 * upper}]
    assert np.isfinite(error_budget(rig, hold).today.reach)


def test_what_has_no_deviation_has_no_interval() -> None:
    made = error_budget(rig_from_changes({FRICTION: 250.0, MASS: 11.0}, nominal_values()), TASK)
    assert made.today.reach == 0.0 and {row.name for row in made.shares} == {"coulomb_friction", PARAMETERS}
