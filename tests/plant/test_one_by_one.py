"""Plants without a lock-step, behind its interface: the digits of each plant alone, effects that begin late too."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import COLUMNS, Plant, compose
from eha_core.plant.lockstep import LockStep
from eha_core.plant.one_by_one import OneByOne, side_by_side

STEP = 2e-4
TIME = STEP * np.arange(1500)
GIVEN = {
    "measured_current": 3e-4 * np.sin(40.0 * TIME)[None],
    "measured_spool": 3e-4 * np.sin(40.0 * TIME)[None],
    "measured_flow": np.stack([6e-5 * np.sin(40.0 * TIME), 3.9e-5 * np.sin(40.0 * TIME)]),
    "switched_pump": np.stack([60.0 + 20.0 * np.sin(9.0 * TIME), np.sign(np.sin(20.0 * TIME))]),
}
SETS = [
    {},
    {"coulomb_friction.force": 40.0, "effects_from": 0.1, "effects_until": 0.22},
    {"presliding_friction.force": 30.0, "presliding_friction.static_force": 45.0, "bulk_modulus": 1e9},
    {"position_sensor_lag.time_constant": 0.01, "pressure_sensor_lag.time_constant_b": 0.01, "effects_from": 0.05},
    {
        "coulomb_friction.force": 40.0,
        "coulomb_friction.acts_from": 0.08,
        "position_sensor_lag.time_constant": 0.01,
        "position_sensor_lag.acts_from": 0.05,
        "position_sensor_lag.acts_until": 0.2,
    },
]


@pytest.mark.parametrize("source", GIVEN)
@pytest.mark.parametrize("every", [1, 7])
def test_each_plant_is_what_it_is_alone(source: str, every: int) -> None:
    rig = compose(source=source, cylinder="single_rod")
    plants = [Plant(one, STEP, 0.01, rig) for one in SETS]
    lanes = side_by_side([rig.places(plant.parameters) for plant in plants], STEP, 0.0, rig)
    lanes.place(np.array([[one.state.position, 0.0, one.state.pressure_a, one.state.pressure_b] for one in plants]))
    lanes.start_memory()
    rows = np.zeros((len(TIME) // every, len(COLUMNS), lanes.lanes))
    for first, last in ((0, 490), (490, 1491)):
        out = rows[first // every : last // every]
        lanes.advance(first, GIVEN[source][:, first:last], every, out)
    shown = [place for place, name in enumerate(COLUMNS) if name not in rig.source.hides]
    for lane, plant in enumerate(plants):
        alone = plant.run(GIVEN[source].T[:1491], every).values
        assert rows[: len(alone), shown, lane].tobytes() == alone[:, shown].tobytes()
        assert lanes.states()[lane, 0] == plant.state.position or every != 1


def test_leakage_that_is_added_is_that_of_the_parameters() -> None:
    rig = compose(source="measured_spool", cylinder="single_rod")
    values = rig.nominal_values()
    leaking = {**values, "internal_leakage": values["internal_leakage"] + 2e-11}
    found = []
    for places, change in ((values, 2e-11), (leaking, 0.0)):
        lanes = side_by_side([rig.places(places)], STEP, 1e-4, rig)
        lanes.place(np.array([[0.0, 0.0, 8e6, 1.2e7]]))
        lanes.start_memory()
        lanes.add_leakage(change)
        rows = np.zeros((100, 4, 1))
        lanes.advance(0, np.full((1, 100), 1e-4), 1, rows)
        found.append(rows)
    assert found[0].tobytes() == found[1].tobytes()


def test_plants_on_a_voltage_go_in_lock_step() -> None:
    for composition in (compose(), compose(cylinder="rotary_vane"), compose(source="measured_force")):
        places = composition.places(composition.nominal_values())
        assert isinstance(side_by_side([places], STEP, 0.0, composition), LockStep)
    rig = compose(source="measured_flow")
    assert isinstance(side_by_side([rig.places(rig.nominal_values())], STEP, 0.0, rig), OneByOne)
