"""Command delay and spool hysteresis against exact shifts and a play operator of its own."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.plant import Plant


def play(values: np.ndarray, half_width: float, start: float) -> np.ndarray:
    """The play operator, one value at a time."""
    out, held = [], start
    for value in values:
        if value - held > half_width:
            held = value - half_width
        elif held - value > half_width:
            held = value + half_width
        out.append(held)
    return np.array(out)


@pytest.mark.parametrize("steps", [1, 7, 50, 2000])
def test_a_delay_of_whole_steps_shifts_everything_by_so_many_rows(steps: int) -> None:
    generator = np.random.default_rng(3)
    voltages = 0.05 * np.repeat(generator.normal(size=50), 20)
    prompt = Plant().run(voltages)
    late = Plant({"command_delay.delay": steps * 1e-4}).run(np.concatenate([voltages, np.zeros(steps)]))
    assert late.position[steps:] == pytest.approx(prompt.position, rel=1e-9, abs=1e-15)
    assert np.all(late.current[:steps] == 0.0)
    assert np.array_equal(late.voltage[: len(voltages)], voltages)


def test_a_delay_between_steps_delays_the_current_by_it() -> None:
    delay, step_size = 3.37e-3, 1e-4
    voltages = 0.05 * np.sin(2.0 * np.pi * 5.0 * step_size * np.arange(5000))
    late, prompt = Plant({"command_delay.delay": delay}).run(voltages), Plant().run(voltages)
    expected = np.interp(prompt.time - delay, prompt.time, prompt.current)
    later = prompt.time > 0.01
    assert late.current[later] == pytest.approx(expected[later], abs=1e-5 * np.max(expected))


def test_the_longest_delay_is_kept_through_many_turns_of_the_ring() -> None:
    voltages = 0.01 * np.sign(np.sin(2.0 * np.pi * 3.0 * 1e-3 * np.arange(3000)))
    late, prompt = Plant({"command_delay.delay": 0.2}, 1e-3).run(voltages), Plant(step_size=1e-3).run(voltages)
    assert late.current[200:] == pytest.approx(prompt.current[:-200], rel=1e-9, abs=1e-15)


def test_the_spool_follows_a_slow_current_with_play() -> None:
    half_width = 2e-4
    time = 1e-4 * np.arange(60000)
    voltages = 0.1 * np.sin(2.0 * np.pi * 0.4 * time) + 0.03 * np.sin(2.0 * np.pi * 1.1 * time)
    found = Plant({"spool_hysteresis.half_width": half_width}).run(voltages)
    expected = play(found.current, half_width, 0.0)
    # the spool itself trails the target by 2 xi / w = 1.8 ms, and overshoots a little where the play is taken up
    trailing = 1.5 * 2.0 * 0.48 / 543.0 * np.max(np.abs(np.gradient(found.current, 1e-4)))
    assert np.max(np.abs(found.spool_position - expected)) < trailing
    assert trailing < 0.1 * half_width
    assert np.max(np.abs(found.current - expected)) == pytest.approx(half_width)


def test_a_current_within_the_play_moves_nothing() -> None:
    found = Plant({"spool_hysteresis.half_width": 2e-4}).run(0.019 * np.sin(2.0 * np.pi * 1e-3 * np.arange(5000)))
    assert np.all(found.spool_position == 0.0)
