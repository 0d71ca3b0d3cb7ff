"""The ends of the stroke and boiling oil: the state stays finite and where an actuator can be, whatever is asked."""

from __future__ import annotations

import numpy as np
import pytest
from legal_parameters import draw_nominal, wild_voltages

from eha_core.plant import Plant


@pytest.mark.parametrize("step_size", [1e-6, 1e-5, 1e-4, 1e-3])
@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_full_voltage_runs_the_piston_onto_its_end_and_holds_it(step_size: float, direction: float) -> None:
    plant = Plant(step_size=step_size, initial_position=0.09 * direction)
    found = plant.run(np.full(round(0.06 / step_size), 10.0 * direction))
    assert np.max(np.abs(found.position)) == 0.1
    assert found.position[-1] == 0.1 * direction
    assert found.velocity[-1] == 0.0
    assert max(found.pressure_a[-1], found.pressure_b[-1]) == pytest.approx(2.1e7, rel=1e-2)
    # the wall takes the force that the pressures leave over; F_f counts it against positive motion
    assert found.friction_force[-1] == pytest.approx(found.hydraulic_force[-1] - found.position[-1] * 10.0, rel=1e-6)


def test_piston_leaves_its_end_when_the_command_turns() -> None:
    plant = Plant(initial_position=0.1)
    plant.advance(5.0, 200)
    assert plant.state.position == 0.1
    plant.advance(-5.0, 300)
    assert plant.state.position < 0.09


@pytest.mark.parametrize("seed", range(150))
def test_any_legal_plant_under_any_command_stays_where_an_actuator_can_be(seed: int) -> None:
    generator = np.random.default_rng(seed)
    values = draw_nominal(generator)
    stroke = values["actuator_displacement"]
    step_size = float(generator.choice([1e-6, 1e-5, 1e-4, 1e-3]))
    plant = Plant(values, step_size, initial_position=stroke * float(generator.uniform(-1.0, 1.0)))
    found = plant.run(wild_voltages(generator, 600))
    assert np.all(np.isfinite(found.values))
    assert np.max(np.abs(found.position)) <= stroke
    assert min(found.pressure_a.min(), found.pressure_b.min()) >= -values["atmospheric_pressure"]
    assert np.max(np.abs(found.current)) <= values["saturation_current"]


def test_oil_that_is_torn_apart_boils_at_zero_absolute_pressure() -> None:
    # a load that drags the piston faster than the shut valve lets oil in
    found = Plant({"constant_load.force": 1e5, "internal_leakage": 0.0}).run(np.zeros(200))
    assert found.pressure_b.min() == -101325.0 or found.pressure_a.min() == -101325.0
    assert np.all(np.isfinite(found.values))
