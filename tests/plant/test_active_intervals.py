"""Effects act in the span of time that the parameters give, to the step, however the steps are run."""

import numpy as np
import pytest

from eha_core.plant import Plant
from eha_core.plant.active_intervals import (
    BEGINS,
    ENDS,
    EVERY,
    FIRST,
    FIRST_ROW,
    LAST,
    LAST_ROW,
    Timetable,
    instants,
    intervals,
    stretches,
)

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


def test_each_effect_acts_in_its_own_span_of_that_of_all() -> None:
    """A lag from 30 ms on, friction from 50.3 to 90 ms, a load to 120.1 ms, all between 20 and 150 ms."""
    voltages = sine(2000)
    switched = {"coulomb_friction.force": 300.0, "constant_load.force": 200.0,
                "position_sensor_lag.time_constant": 0.02}  # fmt: skip
    acts = {"coulomb_friction.acts_from": 0.0503, "coulomb_friction.acts_until": 0.09,
            "constant_load.acts_until": 0.1201, "position_sensor_lag.acts_from": 0.03,
            "effects_from": 0.02, "effects_until": 0.15}  # fmt: skip
    whole = Plant(switched | acts).run(voltages).values
    plant, off = Plant(), dict.fromkeys(switched, 0.0)
    by_hand = []
    for until, on in ((200, ""), (300, "constant"), (503, "constant position"), (900, "constant position coulomb"),
                      (1201, "constant position"), (1500, "position"), (2000, "")):  # fmt: skip
        plant.set_parameters(off | {name: value for name, value in switched.items() if name.split("_")[0] in on})
        by_hand.append(plant.run(voltages[plant.step_count : until]).values)
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
    ("first", "count", "every", "spans"),
    [(0, 30, 4, ((10, 23), (0, 0))), (5, 17, 5, ((6, 7), (0, 20))), (3, 9, 100, ((4, 8), (7, 900), (8, 5)))],
)
def test_every_step_and_every_row_comes_once(first, count, every, spans) -> None:
    steps, rows = [], []
    for interval in intervals(first, count, every, Timetable(spans)):
        here = range(interval.steps.start, interval.steps.stop)
        steps += here
        rows += range(interval.rows.start, interval.rows.stop)
        assert len(here) // interval.every == interval.rows.stop - interval.rows.start
        for step in here:
            assert interval.acting == tuple(begin <= first + step < end for begin, end in spans)
        begins = [first + here[0] == begin > 0 and begin < end for begin, end in spans]
        assert interval.beginning == tuple(begins)
    assert steps == list(range(count))
    assert rows == list(range(count // every))


@pytest.mark.parametrize(
    ("edges", "every", "spans", "apart"),
    [
        ((0, 20, 40, 70), 5, ((0, 900),), ()),
        ((0, 20, 40, 70), 5, ((0, 900), (23, 41)), (40,)),
        ((0, 20, 40, 70), 10, ((20, 40), (3, 7), (69, 70), (-5, 70)), (20, 40)),
        ((0, 8), 4, ((1, 2), (2, 3), (50, 60)), ()),
    ],
)
def test_windows_are_taken_whole_but_where_an_effect_begins_or_ceases_to_act(edges, every, spans, apart) -> None:
    cuts = instants(spans)
    steps, rows, begun, ended = [], [], [], []
    for stretch in stretches(np.array(edges), every, sorted(cuts), apart):
        for piece in stretch:
            first, last = int(piece[FIRST]), int(piece[LAST])
            assert [begin <= first < end for begin, end in spans] == [begin <= last - 1 < end for begin, end in spans]
            assert (last - first) // piece[EVERY] == piece[LAST_ROW] - piece[FIRST_ROW]
            steps += range(first, last)
            rows += range(piece[FIRST_ROW], piece[LAST_ROW])
            begun += [(piece[BEGINS], first)] if piece[BEGINS] >= 0 else []
            ended += [(piece[ENDS], last)] if piece[ENDS] >= 0 else []
        inside = range(int(stretch[0, FIRST]) + 1, int(stretch[-1, LAST]))
        assert not {*cuts, *apart}.intersection(inside)
    assert steps == list(range(edges[-1]))
    assert rows == list(range(edges[-1] // every))
    assert begun == list(enumerate(edges[:-1]))
    assert ended == list(enumerate(edges[1:]))


def test_what_is_off_cuts_nothing() -> None:
    assert instants([(0, 0), (8, 5), (4, 9)]) == {4, 9}


def test_a_timetable_says_of_every_step_what_the_spans_say() -> None:
    spans = ((0, 40), (7, 40), (12, 12), (0, 0), (25, 90))
    timetable = Timetable(spans)
    for step in range(100):
        assert timetable.acting(step) == tuple(begin <= step < end for begin, end in spans)
        assert timetable.beginning(step) == tuple(0 < begin == step < end for begin, end in spans)
