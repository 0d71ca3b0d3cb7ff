"""A single step against its closed form: figures, their intervals, end stops, and what is rightly left open."""

from __future__ import annotations

import numpy as np
import pytest
from stepped import motion, read, table

from eha_core.step_tests import Estimate, Step


def only(files: dict[str, np.ndarray]) -> Step:
    (step,) = read([files]).steps
    return step


def holds(estimate: Estimate | None, truth: float) -> bool:
    return estimate is not None and abs(estimate.value - truth) <= estimate.reach


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    random = np.random.default_rng(11)
    inside: dict[str, list[bool]] = {"delay": [], "rise": [], "speed": [], "stopping": []}
    for _ in range(200):
        truth = {"delay": random.uniform(0.03, 0.2), "rise": random.uniform(0.02, 0.15),
                 "speed": random.uniform(5.0, 40.0), "stopping": random.uniform(0.03, 0.1)}  # fmt: skip
        step = only(table(50.0, random, speed=truth["speed"], delay=truth["delay"], lag=truth["rise"],
                          stopping=truth["stopping"], fall=random.uniform(0.02, 0.06)))  # fmt: skip
        for name, found in inside.items():
            if getattr(step, name) is not None:
                found.append(holds(getattr(step, name), truth[name]))
    for name, found in inside.items():
        assert len(found) > 180, name
        assert 0.90 <= np.mean(found) <= 0.99, name


def test_the_motion_after_a_stop_does_not_enter_the_speed() -> None:
    random = np.random.default_rng(12)
    for _ in range(10):
        step = only(table(50.0, random, speed=10.0, stop=10.0))
        assert step.stopped_after == pytest.approx(1.13, abs=0.05)
        assert step.stopped_at is not None and step.stopped_at.value == pytest.approx(110.0, abs=0.06)
        assert step.speed is not None and step.speed.value == pytest.approx(10.0, abs=0.3)
        assert step.stopping is None and "stopped before" in step.open["stopping"]


def test_a_step_that_stops_too_soon_has_no_speed() -> None:
    step = only(table(50.0, np.random.default_rng(13), speed=10.0, stop=1.0))
    assert step.moved and step.stopped_at is not None
    assert step.speed is None and "farther from the stop" in step.open["speed"]


@pytest.mark.parametrize("drift", [0.0, 0.5, -0.8])
def test_a_drift_is_no_motion(drift: float) -> None:
    random = np.random.default_rng(14)
    steps = [only(table(10.0, random, drift=drift)) for _ in range(10)]
    assert not any(step.moved for step in steps)
    assert all(holds(Estimate(step.drift.value, 2.0 * step.drift.reach), drift) for step in steps)


def test_the_speed_counts_beyond_the_drift() -> None:
    step = only(table(50.0, np.random.default_rng(15), speed=-6.0, drift=0.7))
    assert holds(step.speed, -6.0) and step.drift.value == pytest.approx(0.7, abs=0.2)


def test_a_motion_that_still_settles_before_the_step_is_said() -> None:
    random = np.random.default_rng(16)
    columns = table(50.0, random, noise=0.05)
    columns["boom angle [deg]"] += 2.0 * np.exp(-columns["time"] / 0.5)
    step = only(columns)
    assert step.speed is None and "not come to rest" in step.open["level"]


def test_a_short_step_has_no_steady_speed() -> None:
    step = only(table(50.0, np.random.default_rng(17), speed=20.0, lag=0.4, off=1.8, length=3.0))
    assert step.moved and step.speed is None and "hold the command longer" in step.open["speed"]


def test_a_speed_that_changes_has_an_interval_that_holds_the_change() -> None:
    random = np.random.default_rng(18)
    columns = table(50.0, random, speed=10.0, noise=0.02)
    gone = columns["boom angle [deg]"] - 100.0
    columns["boom angle [deg]"] = 100.0 + 40.0 * (1.0 - np.exp(-gone / 40.0))  # from 10 to 6.2 deg/s
    step = only(columns)
    assert step.speed is not None and step.speed.value - step.speed.reach < 6.6
    assert step.speed.value + step.speed.reach > 9.0


def test_a_coarse_sensor_shows_no_motion_where_none_is() -> None:
    time = np.arange(0.0, 4.0, 0.01)
    command = np.where((time >= 1.0) & (time < 3.0), 1.0, 0.0)
    files = []
    for level, speed in ((10.0, 0.0), (20.0, 0.8), (50.0, 12.0)):
        stairs = np.round((0.2 + motion(time, speed)) / 0.5) * 0.5
        files.append({"time": time, "duty [%]": level * command, "angle [deg]": stairs})
    still, slow, fast = read(files).steps
    assert not still.moved and still.unseen is not None and still.unseen > 0.1
    assert slow.moved or "level" in slow.open  # three stairs of the sensor are not "no motion"
    assert holds(fast.speed, 12.0)


def test_a_velocity_is_read_alike() -> None:
    random = np.random.default_rng(19)
    columns = table(50.0, random, speed=12.0, noise=0.0)
    time = columns["time"]
    rate = np.where(time > 1.08, 12.0 * (1.0 - np.exp(-(time - 1.08) / 0.05)), 0.0)
    rate = np.where(time > 3.05, 12.0 * np.exp(-(time - 3.05) / 0.03), rate)
    step = only({"time": time, "duty [%]": columns["duty [%]"],
                 "boom speed [deg/s]": 0.4 + rate + random.normal(0.0, 0.3, time.size)})  # fmt: skip
    assert holds(step.speed, 12.0) and holds(step.delay, 0.08) and holds(step.rise, 0.05)
    assert holds(step.stopping, 0.05) and holds(step.drift, 0.4)


def test_a_motion_ahead_of_its_command_is_said() -> None:
    step = only(table(50.0, np.random.default_rng(20), speed=20.0, delay=-0.3))
    assert step.delay is None and "one clock" in step.open["delay"]


def test_a_record_that_ends_with_the_command_leaves_the_stopping_open() -> None:
    step = only(table(50.0, np.random.default_rng(21), off=9.0))
    assert step.speed is not None and "record on" in step.open["stopping"]


def test_a_short_way_to_the_stop_makes_no_speed_too_sure() -> None:
    random = np.random.default_rng(22)
    found = [only(table(50.0, random, speed=10.0, stop=random.uniform(1.0, 5.0))).speed for _ in range(60)]
    told = [speed for speed in found if speed is not None]
    assert 10 < len(told) < 50
    assert np.mean([holds(speed, 10.0) for speed in told]) >= 0.90


def test_a_record_that_begins_in_the_midst_of_a_step_shows_nothing() -> None:
    columns = table(50.0, np.random.default_rng(23), speed=10.0)
    late = {name: values[150:] for name, values in columns.items()}
    step = only(late)
    assert step.speed is None and "begin at neutral" in step.open["level"]
