"""Several steps of a direction: dead zone, gain, saturation, delay and end stop, against what was planted."""

from __future__ import annotations

import numpy as np
from stepped import DEAD_ZONE, GAIN, LEVELS, read, speed_of, table

from eha_core.step_tests import Direction, Estimate


def holds(estimate: Estimate | None, truth: float) -> bool:
    return estimate is not None and abs(estimate.value - truth) <= estimate.reach


def positive(files: list[dict[str, np.ndarray]]) -> Direction:
    return next(one for one in read(files).directions if one.sign > 0)


def test_dead_zone_and_gain_with_their_bracket() -> None:
    inside = []
    for seed in range(12):
        random = np.random.default_rng(seed)
        found = positive([table(level, random) for level in LEVELS])
        assert (found.still, found.moving) == (15.0, 20.0)
        assert found.unseen is not None and 0.0 < found.unseen < speed_of(20.0)
        inside += [holds(found.dead_zone, DEAD_ZONE), holds(found.gain, GAIN)]
        assert holds(found.delay, 0.08)
        assert found.saturation is None and found.delay_slope is None
    assert np.mean(inside) >= 0.85


def test_steps_that_scatter_widen_the_intervals() -> None:
    inside, reaches = [], []
    for seed in range(12):
        random = np.random.default_rng(100 + seed)
        files = [table(level, random, speed=speed_of(level) * random.normal(1.0, 0.05), noise=0.02)
                 for level in (*LEVELS[2:], *LEVELS[2:])]  # fmt: skip
        found = positive(files)
        if found.gain is not None:
            inside.append(holds(found.gain, GAIN))
            reaches.append(found.gain.reach)
    assert len(inside) >= 10 and np.mean(inside) >= 0.85
    assert np.median(reaches) > 0.005  # the noise alone would say 0.001


def test_neither_saturation_nor_a_trend_of_the_delay_where_there_is_none() -> None:
    trends = 0
    for seed in range(15):
        random = np.random.default_rng(200 + seed)
        files = [table(level, random, noise=0.05, delay=0.08 + random.normal(0.0, 0.005), length=3.0, off=2.2,
                       speed=speed_of(level) + random.normal(0.0, 0.2)) for level in LEVELS[2:]]  # fmt: skip
        found = positive(files)
        assert found.saturation is None
        trends += found.delay_slope is not None
    assert trends <= 1


def test_a_saturation_is_found_and_does_not_enter_the_line() -> None:
    random = np.random.default_rng(31)
    files = [
        table(level, random, speed=min(speed_of(level), 10.0)) for level in (15.0, 20.0, 25.0, 30.0, 40.0, 60.0, 80.0)
    ]
    found = positive(files)
    assert holds(found.saturation, 10.0) and holds(found.knee, DEAD_ZONE + 10.0 / GAIN)
    assert holds(found.gain, GAIN) and holds(found.dead_zone, DEAD_ZONE)


def test_a_bent_curve_has_no_dead_zone_by_a_line() -> None:
    random = np.random.default_rng(32)
    files = [table(level, random, speed=3.0 * max(level - DEAD_ZONE, 0.0) ** 0.5) for level in LEVELS]
    found = positive(files)
    assert found.dead_zone is None and found.gain is None and "bent" in found.open["dead_zone"]
    assert (found.still, found.moving) == (15.0, 20.0)


def test_a_delay_that_falls_with_the_level() -> None:
    random = np.random.default_rng(33)
    files = [table(level, random, delay=0.16 - 0.0015 * level, noise=0.02) for level in LEVELS]
    found = positive(files)
    assert holds(found.delay_slope, -0.0015)


def test_an_end_stop_in_angle_units() -> None:
    random = np.random.default_rng(34)
    files = [table(level, random, stop=15.0) for level in (*LEVELS, 55.0)]
    found = positive(files)
    assert holds(found.end_stop, 115.0) and found.end_stop is not None and found.end_stop.reach < 0.3
    assert holds(found.gain, GAIN)


def test_one_stop_alone_may_be_a_hindrance() -> None:
    random = np.random.default_rng(35)
    files = [table(level, random, stop=30.0) for level in LEVELS]
    found = positive(files)
    assert found.end_stop is None and "hindrance" in found.open["end_stop"]


def test_a_step_that_begins_at_the_stop_says_nothing_of_the_dead_zone() -> None:
    random = np.random.default_rng(36)
    files = [table(level, random, stop=15.0) for level in (*LEVELS, 55.0)]
    files.append(table(45.0, random, speed=0.0, start=115.0))
    found = positive(files)
    assert (found.still, found.moving) == (15.0, 20.0) and holds(found.dead_zone, DEAD_ZONE)


def test_one_level_shows_no_dead_zone() -> None:
    random = np.random.default_rng(37)
    found = positive([table(30.0, random) for _ in range(4)])
    assert found.dead_zone is None and found.gain is None and "one level" in found.open["dead_zone"]
    assert found.still is None and found.moving == 30.0 and holds(found.delay, 0.08)
    assert any("smaller levels" in remark for remark in found.remarks)


def test_two_steps_show_no_scatter() -> None:
    random = np.random.default_rng(38)
    found = positive([table(level, random) for level in (30.0, 50.0)])
    assert found.dead_zone is None and "scatter" in found.open["dead_zone"]


def test_a_line_is_not_extended_far_to_the_dead_zone() -> None:
    random = np.random.default_rng(42)
    found = positive([table(level, random) for level in (40.0, 50.0, 60.0)])
    assert holds(found.gain, GAIN)
    assert found.dead_zone is None and "step to smaller levels" in found.open["dead_zone"]


def test_no_motion_at_all() -> None:
    random = np.random.default_rng(39)
    found = positive([table(level, random) for level in (5.0, 10.0, 15.0)])
    assert (found.still, found.moving) == (15.0, None)
    assert found.dead_zone is None and "larger levels" in found.open["dead_zone"]


def test_both_directions_of_one_file() -> None:
    random = np.random.default_rng(40)
    time = np.arange(0.0, 16.0, 0.01)
    command, place = np.zeros(time.size), np.zeros(time.size)
    for number, level in enumerate((20.0, -25.0, 40.0, -50.0, 30.0, -40.0)):
        on = 1.0 + 2.5 * number
        part = table(level, random, noise=0.0, start=0.0, length=17.0, on=on, off=on + 1.0)
        command[(time >= on) & (time < on + 1.0)] = level
        place += np.interp(time, part["time"], part["boom angle [deg]"])
    place += random.normal(0.0, 0.05, time.size)
    found = read([{"time": time, "duty [%]": command, "angle [deg]": place}])
    assert [step.level for step in found.steps] == [20.0, -25.0, 40.0, -50.0, 30.0, -40.0]
    for direction in found.directions:
        assert holds(direction.gain, direction.sign * GAIN) and holds(direction.dead_zone, DEAD_ZONE)


def test_a_neutral_that_is_not_zero() -> None:
    random = np.random.default_rng(41)
    files = [table(level, random) for level in LEVELS]
    shifted = [{**columns, "duty [%]": 50.0 + columns["duty [%]"]} for columns in files]
    assert positive(shifted) == positive(files)


def test_a_measured_current_that_lags_and_a_polarity_that_is_turned() -> None:
    random = np.random.default_rng(43)
    files = []
    for level in LEVELS:
        columns = table(level, random, noise=0.05)
        time = columns["time"]
        risen, fallen = (1.0 - np.exp(-np.maximum(time - at, 0.0) / 0.03) for at in (1.0, 3.0))
        current = 4.0 + 10.0 * level * (risen - fallen) + random.normal(0.0, 2.0, time.size)
        files.append({"time": time, "current [mA]": current, "angle [deg]": 200.0 - columns["boom angle [deg]"]})
    found = positive(files)
    assert holds(found.gain, -0.1 * GAIN) and holds(found.dead_zone, 10.0 * DEAD_ZONE)
    assert found.delay is not None and found.delay.reach > 0.02  # the current takes that long to change
