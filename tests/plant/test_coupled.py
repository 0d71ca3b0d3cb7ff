"""The plant on a load moved elsewhere, here by a semi-implicit Euler step, against the plant that moves its own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from eha_core.effects import effects
from eha_core.effects.declaration import Effect
from eha_core.errors import ParameterError
from eha_core.parameters import nominal_values
from eha_core.plant import COLUMNS, Plant, compose
from eha_core.plant.coupled import CoupledPlant
from eha_core.plant.state import COLUMN

Array = NDArray[np.float64]

STEP = 1e-4
MASS = nominal_values()["moving_mass"]
VOLTAGES = 0.2 * np.sin(2.0 * np.pi * 5.0 * STEP * np.arange(3000))
SHORT = VOLTAGES[:2000]


def coupled(plant: CoupledPlant, voltages: Array, mass: float = MASS, steps: int = 1) -> Array:
    """What it reports after each step of a mass that its reaction alone moves; dry friction is a projection."""
    position = velocity = 0.0
    duration = steps * plant.step_size
    rows = []
    for voltage in voltages:
        force, dry, added = plant.reaction(mass, velocity, duration)
        share = duration / (mass + added)
        free = velocity + share * force
        velocity = float(np.sign(free)) * max(0.0, abs(free) - share * dry)
        start, position = position, position + duration * velocity
        plant.follow(float(voltage), start, position, steps)
        rows.append(plant.state)
    return np.array(rows)


def alone(parameters: Mapping[str, float], voltages: Array, steps: int = 1) -> Array:
    """The plant that moves its own mass."""
    plant = Plant(parameters, STEP)
    rows = []
    for voltage in voltages:
        plant.advance(float(voltage), steps)
        rows.append(plant.state)
    return np.array(rows)


def deviation(found: Array, expected: Array, column: int = COLUMN.position) -> float:
    """RMS of a column."""
    return float(np.sqrt(np.mean((found[:, column] - expected[:, column]) ** 2)))


def typical(effect: Effect) -> dict[str, float]:
    return {name: row.typical for name, row in zip(effect.parameter_names(), effect.parameters, strict=True)}


@pytest.mark.parametrize("effect", effects(), ids=lambda effect: effect.id)
def test_a_mass_moved_outside_follows_the_plant_under_every_effect(effect: Effect) -> None:
    found, expected = coupled(CoupledPlant(typical(effect)), SHORT), alone(typical(effect), SHORT)
    assert np.ptp(expected[:, COLUMN.position]) > 1e-3
    assert deviation(found, expected) < 1e-6
    for name in ("measured_position", "measured_pressure_a", "measured_pressure_b", "flow_a", "supply_pressure"):
        column = COLUMNS.index(name)
        assert deviation(found, expected, column) < 1e-3 * np.max(np.abs(expected[:, column])), name


def test_the_deviation_falls_with_the_square_of_the_step() -> None:
    voltages = np.repeat(VOLTAGES, 4)
    truth = Plant({}, 0.25 * STEP).run(voltages).values
    coarse = coupled(CoupledPlant({}, STEP), VOLTAGES)
    fine = coupled(CoupledPlant({}, 0.5 * STEP), np.repeat(VOLTAGES, 2))
    order = np.log2(deviation(coarse, truth[3::4]) / deviation(fine[1::2], truth[3::4]))
    assert 1.5 < order < 2.5


def test_friction_that_begins_later_acts_from_then_on() -> None:
    late = {"coulomb_friction.force": 500.0, "coulomb_friction.acts_from": 0.1}
    found = coupled(CoupledPlant(late), VOLTAGES)
    assert deviation(found, alone(late, VOLTAGES)) < 1e-6
    assert deviation(found, alone({"coulomb_friction.force": 500.0}, VOLTAGES)) > 1e-5


def test_a_light_load_on_stiff_oil_is_stable_at_a_long_step() -> None:
    # explicit steps of 1 ms diverge where the oil's frequency exceeds 2000 rad/s; here it is 18 000 rad/s
    light = {"moving_mass": 0.05}
    voltages = VOLTAGES[::10]
    found = coupled(CoupledPlant(light), voltages, mass=0.05, steps=10)
    assert deviation(found, alone(light, voltages, steps=10)) < 1e-5


def test_dry_friction_holds_a_load_exactly() -> None:
    held = {"coulomb_friction.force": 250.0, "constant_load.force": 200.0}
    found = coupled(CoupledPlant(held), np.zeros(100))
    assert np.all(found[:, COLUMN.position] == 0.0)
    assert np.all(np.isnan(found[:, COLUMN.friction_force]))


def test_beyond_the_stroke_the_piston_stands_at_its_end() -> None:
    plant = CoupledPlant({})
    before = plant.state.pressure_b
    for index in range(20):
        plant.follow(0.0, 0.101 + 1e-4 * index, 0.1011 + 1e-4 * index)
    assert plant.state.position == 0.1
    assert plant.state.pressure_b == pytest.approx(before, rel=1e-6)


@pytest.mark.parametrize(
    ("parts", "named"),
    [({"source": "measured_force"}, "plant.source = measured_force"), ({"cylinder": "rotary_vane"}, "rotary_vane")],
)
def test_what_no_voltage_moves_along_a_line_is_refused(parts: dict[str, str], named: str) -> None:
    with pytest.raises(ParameterError, match=named):
        CoupledPlant(composition=compose(**parts))
