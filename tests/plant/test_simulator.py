"""`Plant` as an object: time, parameters at run time, effects that begin in the middle of a run."""

from __future__ import annotations

import numpy as np
import pytest

from eha_core.errors import ParameterError
from eha_core.plant import COLUMNS, Plant


def sine(count: int, amplitude: float = 0.05) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * 2.0 * 1e-4 * np.arange(count))


def test_one_run_equals_many_short_ones() -> None:
    voltages = sine(900)
    whole = Plant().run(voltages)
    plant = Plant()
    parts = np.concatenate([plant.run(part).values for part in np.split(voltages, [1, 7, 300, 301])])
    assert np.array_equal(whole.values, parts)
    assert plant.time == pytest.approx(0.09)


def test_every_takes_rows_from_the_same_run() -> None:
    whole, thinned = Plant().run(sine(1000)), Plant().run(sine(1000), every=10)
    assert np.array_equal(thinned.values, whole.values[9::10])
    assert np.array_equal(thinned.time, whole.time[9::10])


def test_advance_holds_the_voltage() -> None:
    plant, other = Plant(), Plant()
    plant.advance(0.02, 250)
    rows = other.run(np.full(250, 0.02))
    assert plant.state == pytest.approx(tuple(rows.values[-1]), rel=0.0, abs=0.0)


@pytest.mark.parametrize(
    "acting",
    [
        {},
        {"effects_from": 0.0105, "effects_until": 0.0612},
        {"effects_until": 0.02},
        {"coulomb_friction.acts_from": 0.0105, "position_sensor_lag.acts_until": 0.07},
    ],
)
def test_ticks_of_any_length_are_the_run_to_the_last_bit(acting: dict[str, float]) -> None:
    effects = {"coulomb_friction.force": 300.0, "position_sensor_lag.time_constant": 0.01, **acting}
    ticking, running = Plant(effects), Plant(effects)
    lengths = [10] * 30 + [1] * 40 + [7] * 20 + [400]
    voltages = 0.05 * np.sin(np.arange(len(lengths)))
    rows = running.run(np.repeat(voltages, lengths)).values[np.cumsum(lengths) - 1]
    for voltage, steps, row in zip(voltages, lengths, rows, strict=True):
        ticking.advance(voltage, steps)
        assert ticking.state == tuple(row)
    assert ticking.time == running.time


def test_a_tick_under_no_number_is_refused_and_changes_nothing() -> None:
    plant = Plant()
    plant.advance(0.02, 10)
    before = plant.state
    for voltage in (np.nan, np.inf):
        with pytest.raises(ParameterError, match="voltage command is not finite"):
            plant.advance(voltage, 10)
    assert (plant.state, plant.step_count) == (before, 10)


def test_reset_returns_to_the_start_and_keeps_the_parameters() -> None:
    plant = Plant({"moving_mass": 20.0}, initial_position=0.01)
    first = plant.run(sine(300)).values
    plant.reset()
    assert plant.time == 0.0
    assert plant.state.position == 0.01
    assert plant.parameters["moving_mass"] == 20.0
    assert np.array_equal(plant.run(sine(300)).values, first)


def test_a_plant_goes_on_from_a_moment_to_which_it_returned() -> None:
    lags = {"command_delay.delay": 0.004, "position_sensor_lag.time_constant": 0.01}
    plant = Plant({"presliding_friction.force": 200.0, **lags})
    plant.run(sine(700))
    moment, state = plant.moment(), plant.state
    first = plant.run(sine(500, 0.3))
    plant.return_to(moment)
    assert plant.state == state
    again = plant.run(sine(500, 0.3))
    assert np.array_equal(again.values, first.values) and np.array_equal(again.time, first.time)


def test_a_parameter_acts_on_the_next_step() -> None:
    plant = Plant()
    plant.advance(0.02, 100)
    plant.set_parameters({"internal_leakage": 1e-10})
    plant.advance(0.02, 1)
    assert plant.state.internal_leakage == 1e-10
    assert plant.state.internal_leakage_flow == pytest.approx(
        1e-10 * (plant.state.pressure_a - plant.state.pressure_b), rel=1e-12
    )


def test_refused_parameters_change_nothing() -> None:
    plant, untouched = Plant(), Plant()
    with pytest.raises(ParameterError, match="moving_mass = -1 kg is out of range"):
        plant.set_parameters({"internal_leakage": 1e-10, "moving_mass": -1.0})
    assert plant.parameters == untouched.parameters
    assert np.array_equal(plant.run(sine(200)).values, untouched.run(sine(200)).values)


@pytest.mark.parametrize(
    ("effect", "column"),
    [
        ({"position_sensor_lag.time_constant": 0.02}, "measured_position"),
        ({"position_sensor_backlash.half_width": 1e-4}, "measured_position"),
        ({"pressure_sensor_lag.time_constant_b": 0.02}, "measured_pressure_b"),
        ({"spool_hysteresis.half_width": 1e-4}, "spool_position"),
        ({"supply_pressure_droop.resistance": 3e10}, "supply_pressure"),
        ({"return_back_pressure.resistance": 3e10}, "return_pressure"),
        ({"presliding_friction.force": 200.0, "presliding_friction.static_force": 300.0}, "velocity"),
    ],
)
def test_an_effect_with_memory_begins_from_the_present_each_time(effect: dict[str, float], column: str) -> None:
    plant = Plant()
    scale = np.ptp(getattr(Plant().run(sine(20000)), column)) or 1e6  # the nominal supply stands still
    neutral = dict.fromkeys(effect, 0.0)
    for moment in (3100, 4400):
        plant.set_parameters(neutral)
        plant.run(sine(moment))
        before = getattr(plant.state, column)
        plant.set_parameters(effect)
        plant.advance(0.05, 1)
        assert getattr(plant.state, column) == pytest.approx(before, abs=0.02 * scale)


@pytest.mark.parametrize("step_size", [0.0, 1e-7, 2e-3, float("nan"), -1e-4])
def test_steps_that_cannot_be_taken_are_refused(step_size: float) -> None:
    with pytest.raises(ParameterError, match="step_size = .* out of range; give 1e-6 to 1e-3 s"):
        Plant(step_size=step_size)


def test_a_start_outside_the_stroke_is_refused() -> None:
    with pytest.raises(ParameterError, match="initial_position = 0.11 m is outside the stroke"):
        Plant(initial_position=0.11)


def test_a_command_that_is_no_number_is_refused() -> None:
    plant = Plant()
    with pytest.raises(ParameterError, match="voltage command is not finite"):
        plant.run(np.array([0.0, np.nan]))
    assert plant.time == 0.0


def test_a_trajectory_offers_each_column_by_name_and_no_other() -> None:
    found = Plant().run(sine(10))
    for index, name in enumerate(COLUMNS):
        assert np.array_equal(getattr(found, name), found.values[:, index])
    with pytest.raises(AttributeError):
        _ = found.temperature


def test_a_shrunk_stroke_takes_the_piston_along() -> None:
    plant = Plant(initial_position=0.08)
    plant.set_parameters({"actuator_displacement": 0.05})
    plant.advance(0.0, 1)
    assert plant.state.position == pytest.approx(0.05, abs=1e-6)
