"""Many plants at once are the plants that each of them is alone; and what cannot be simulated is said."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, SEEN, Plant, simulate_many

COMMAND = 0.1 * np.sin(2 * np.pi * 3 * 2e-4 * np.arange(1003))


@pytest.mark.parametrize(("jobs", "columns"), [(1, COLUMNS), (2, SEEN), (1, ("pressure_b", "measured_position"))])
def test_each_is_what_a_plant_of_its_own_gives(jobs: int, columns: tuple[str, ...]) -> None:
    generator = np.random.default_rng(5)
    sets = [
        {"moving_mass": generator.uniform(5.0, 20.0), "coulomb_friction.force": float(generator.choice([0.0, 300.0]))}
        for _ in range(53)
    ]
    found = simulate_many(sets, COMMAND, step_size=2e-4, every=10, initial_position=0.02, columns=columns, jobs=jobs)
    assert found.values.shape == (53, 100, len(columns))
    for number, one in enumerate(sets):
        alone = Plant(one, 2e-4, 0.02).run(COMMAND, 10)
        assert np.array_equal(found.time, alone.time)
        for name in columns:
            assert np.array_equal(getattr(found, name)[number], getattr(alone, name))


@pytest.mark.parametrize("columns", [SEEN, COLUMNS, ("velocity",)], ids=len)
def test_a_few_steps_of_two_plants(columns: tuple[str, ...]) -> None:
    sets = [{"moving_mass": 5.0}, {"moving_mass": 20.0}]
    found = simulate_many(sets, COMMAND[20:50], step_size=2e-4, every=7, columns=columns)
    assert found.time == pytest.approx([1.4e-3, 2.8e-3, 4.2e-3, 5.6e-3], rel=1e-12)
    for number, one in enumerate(sets):
        alone = Plant(one, 2e-4).run(COMMAND[20:50], 7)
        assert found.values[number].tolist() == [[getattr(alone, name)[k] for name in columns] for k in range(4)]


def test_none_gives_none() -> None:
    assert simulate_many([], COMMAND).values.shape == (0, 1003, len(COLUMNS))


@pytest.mark.parametrize(
    ("sets", "options", "said"),
    [
        ([{}, {"moving_mass": -1.0}], {}, "parameter set 1: moving_mass"),
        ([{}, {}, {"mass": 1.0}], {}, "parameter set 2: there is no parameter named mass"),
        ([{"actuator_displacement": 0.01}], {"initial_position": 0.02}, "parameter set 0: initial_position"),
        ([{}], {"step_size": 0.1}, "step_size = 0.1 s"),
        ([{}], {"columns": ["speed"]}, "no column speed"),
        ([{}], {"every": 0}, "every = 0"),
        ([{}] * 50_000, {"every": 2}, "give a larger `every`"),
    ],
)
def test_what_cannot_be_simulated_is_said(sets: list[dict[str, float]], options: dict, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        simulate_many(sets, COMMAND, **options)


def test_a_command_is_finite() -> None:
    with pytest.raises(ParameterError, match="finite"):
        simulate_many([{}], np.array([0.0, np.nan]))
