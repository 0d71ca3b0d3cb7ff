"""Effects act in the span of time that the parameters give, to the step, however the steps are run."""

import numpy as np
import pytest

from eha_core.plant import Plant
from eha_core.plant.active_intervals import intervals

FRICTION = {"coulomb_friction.force": 300.0}
SPAN = {"effects_from": 0.0503, "effects_until": 0.1201}


def sine(steps: int) -> np.ndarray:
    return 0.05 * np.sin(2 * np.pi * 5 * np.arange(steps) * 1e-4)


def test_an_effect_of_a_span_is_one_switched_on_and_off_by_hand() -> None:
    voltages = sine(2000)
    whole = Plant(FRICTION | SPAN).run(voltages).values
    plant = Plant()
    by_hand = [plant.run(voltages[:503]).values]
    plant.set_parameters(FRICTION)
    by_hand.append(plant.run(voltages[503:1201]).values)
    plant.set_parameters({"coulomb_friction.force": 0.0})
    by_hand.append(plant.run(voltages[1201:]).values)
    assert np.array_equal(whole, np.concatenate(by_hand))


@pytest.mark.parametrize("every", [1, 7, 100, 698, 1500])
def test_rows_lie_as_they_would_without_a_span(every: int) -> None:
    thinned, whole = (Plant(FRICTION | SPAN).run(sine(2000), each).values for each in (every, 1))
    assert np.array_equal(thinned, whole[every - 1 :: every])


def test_a_lag_begins_from_the_position_when_it_begins_to_act() -> None:
    plant = Plant({"position_sensor_lag.time_constant": 0.05, "effects_from": 0.1}, initial_position=0.02)
    rows = plant.run(np.full(1400, 0.05))
    assert np.array_equal(rows.measured_position[:1000], rows.position[:1000])
    just_after = rows.position[1000] - rows.measured_position[1000]
    assert 0.0 < just_after < 2e-4 * 1e-1
    assert rows.position[-1] - rows.measured_position[-1] > 10 * just_after


@pytest.mark.parametrize(
    ("first", "count", "every", "acting"), [(0, 30, 4, (10, 23)), (5, 17, 5, (6, 7)), (3, 9, 100, (4, 8))]
)
def test_every_step_and_every_row_comes_once(first: int, count: int, every: int, acting: tuple[int, int]) -> None:
    steps, rows = [], []
    for interval in intervals(first, count, every, acting):
        here = range(interval.steps.start, interval.steps.stop)
        steps += here
        rows += range(interval.rows.start, interval.rows.stop)
        assert len(here) // interval.every == interval.rows.stop - interval.rows.start
        assert {acting[0] <= first + step < acting[1] for step in here} == {interval.acting}
    assert steps == list(range(count))
    assert rows == list(range(count // every))
