"""Single-rod and rotary cylinders against closed forms, and against the double rod that they must not change."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, PAPER, SEEN, Composition, Plant, compose, simulate_many

ROD = compose(cylinder="single_rod")
VANE = compose(cylinder="rotary_vane")
AREAS = {"piston_area": 1.2e-3, "piston_area_b": 7.8e-4}
FREE = {"damping_coefficient": 1.0, "spring_stiffness": 0.0, "internal_leakage": 0.0}
COMMAND = np.repeat([0.02, -0.02, 0.05, -0.03], 500)


def steady(parameters: dict[str, float], voltage: float, composition: Composition = ROD) -> tuple[float, ...]:
    """Velocity, both pressures and both flows once the piston moves steadily through the middle."""
    plant = Plant(parameters, 1e-4, -0.08 if voltage > 0.0 else 0.08, composition)
    plant.advance(voltage, 40000)
    row = plant.state
    return row.velocity, row.pressure_a, row.pressure_b, row.flow_a, row.flow_b


@pytest.mark.parametrize("voltage", [0.02, -0.02])
def test_a_free_single_rod_moves_at_the_flow_over_either_area(voltage: float) -> None:
    """Without friction A_a P_a = A_b P_b; with both ports' orifices that gives the textbook's speed and pressures."""
    velocity, pressure_a, pressure_b, flow_a, flow_b = steady(AREAS | FREE, voltage)
    area_a, area_b = AREAS["piston_area"], AREAS["piston_area_b"]
    assert velocity == pytest.approx(flow_a / area_a, rel=1e-6)
    assert velocity == pytest.approx(flow_b / area_b, rel=1e-6)
    ratio, opening = area_b / area_a, voltage / 100.0
    share = (1.0 if voltage > 0.0 else ratio) / (1.0 + ratio**3)
    assert velocity == pytest.approx(2.38e-5 * opening * np.sqrt(share * 2.1e7) / area_a, rel=1e-4)
    # what lies over the two ports is as the squares of their flows
    meter_in = 2.1e7 - pressure_a if voltage > 0.0 else pressure_a
    meter_out = pressure_b if voltage > 0.0 else 2.1e7 - pressure_b
    assert meter_out / meter_in == pytest.approx(ratio**2, rel=1e-3)


def test_pressure_is_intensified_by_the_ratio_of_the_areas() -> None:
    """Oil pressed into chamber A against a shut annulus: P_b = P_a A_a / A_b, both chambers' oil being compressed."""
    shut = AREAS | FREE | {"damping_coefficient": 2000.0}
    plant = Plant(shut, 1e-4, 0.0, compose(source="measured_flow", cylinder="single_rod"))
    before = plant.state.pressure_a
    fill = np.zeros((20000, 2))
    fill[:1000, 0] = 4e-6
    plant.run(fill, 20000)
    ratio = AREAS["piston_area"] / AREAS["piston_area_b"]
    volume_a, volume_b = (1e-5 + area * 0.1 for area in AREAS.values())
    rise = 4e-6 * 0.1 * 1.4e9 / (volume_a + volume_b * ratio**2)
    assert plant.state.pressure_a - before == pytest.approx(rise, rel=3e-3)
    assert plant.state.pressure_b / plant.state.pressure_a == pytest.approx(ratio, rel=1e-9)


def test_a_single_rod_starts_at_rest() -> None:
    plant = Plant(AREAS | {"internal_leakage": 0.0, "spring_stiffness": 1e4}, 1e-4, 0.03, ROD)
    plant.advance(0.0, 2000)
    assert plant.state.position == pytest.approx(0.03, abs=1e-12)
    assert plant.state.pressure_a + plant.state.pressure_b == pytest.approx(2.1e7, rel=1e-9)


def test_from_equal_pressures_a_single_rod_is_the_double_rod_of_its_areas() -> None:
    rod, paper = Plant(AREAS, 1e-4, 0.0, ROD), Plant(AREAS)
    rod.place(0.0, 0.0, 1.05e7, 1.05e7)
    assert rod.run(COMMAND, 10).values.tobytes() == paper.run(COMMAND, 10).values.tobytes()


def test_a_rod_in_the_wrong_chamber_is_refused() -> None:
    with pytest.raises(ParameterError, match=r"piston_area_b = 0.001 m\^2 is not below piston_area = 0.0009 m\^2"):
        Plant({"piston_area": 9e-4, "piston_area_b": 1e-3}, composition=ROD)


def test_a_vane_is_the_papers_equations_with_angle_for_position() -> None:
    turned = Plant(
        {"vane_displacement": 645e-6, "half_travel": 0.1, "moment_of_inertia": 9.0, "rotational_damping": 2000.0,
         "rotational_stiffness": 10.0},
        composition=VANE,
    )  # fmt: skip
    assert turned.run(COMMAND, 10).values.tobytes() == Plant().run(COMMAND, 10).values.tobytes()


def test_a_free_vane_turns_at_the_flow_over_its_displacement() -> None:
    plant = Plant({"rotational_damping": 0.01, "internal_leakage": 0.0}, 1e-4, -1.4, VANE)
    plant.advance(0.01, 100_000)
    assert plant.state.velocity == pytest.approx(2.38e-5 * 1e-4 * np.sqrt(2.1e7 / 2.0) / 5e-5, rel=1e-4)


def test_names_of_other_parts_are_refused_in_one_line() -> None:
    with pytest.raises(ParameterError, match=r"piston_area does not apply to this plant \(servo_valve, rotary_vane, "):
        Plant({"piston_area": 1e-3}, composition=VANE)
    with pytest.raises(ParameterError, match="vane_displacement does not apply|no parameter named vane_displacement"):
        Plant({"vane_displacement": 1e-3})


def test_a_cylinder_that_turns_needs_a_load_that_does() -> None:
    with pytest.raises(ParameterError, match="sprung_mass moves in m, plant.cylinder = rotary_vane in rad; give"):
        compose(cylinder="rotary_vane", load="sprung_mass")
    assert VANE.load.id == "sprung_inertia"


@pytest.mark.parametrize("composition", [PAPER, ROD, VANE], ids=str)
def test_every_cylinder_goes_in_lock_step_to_the_last_bit(composition: Composition) -> None:
    name = "internal_leakage"
    sets = [{name: value, "coulomb_friction.force": 20.0} for value in (1e-12, 3e-12, 1e-11)]
    for columns in (COLUMNS, SEEN):
        found = simulate_many(sets, COMMAND, every=5, columns=columns, composition=composition).values
        alone = [Plant(one, composition=composition).run(COMMAND, 5) for one in sets]
        places = [COLUMNS.index(column) for column in columns]
        assert found.tobytes() == np.array([one.values[:, places] for one in alone]).tobytes()
