"""What sensors make of the motion: lag, play, gain and offset. None of them may touch the motion itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from eha_core.effects import effects
from eha_core.parameters import nominal_values
from eha_core.plant import Plant, Trajectory

VOLTAGES = 0.05 * np.sin(2.0 * np.pi * 3.0 * 1e-4 * np.arange(8000))


def run(parameters: dict[str, float]) -> Trajectory:
    """The trajectory with a sensor's effect, its states checked to be those without."""
    found, plain = Plant(parameters, initial_position=0.01).run(VOLTAGES), Plant(initial_position=0.01).run(VOLTAGES)
    assert np.array_equal(found.values[:, :18], plain.values[:, :18])
    return found


@pytest.mark.parametrize("time_constant", [1e-6, 1e-3, 0.02, 1.0])
def test_lag_is_a_first_order_filter_of_the_position(time_constant: float) -> None:
    found = run({"position_sensor_lag.time_constant": time_constant})
    filter_of_lag = StateSpace([[-1.0 / time_constant]], [[1.0 / time_constant]], [[1.0]], [[0.0]])
    position = np.concatenate([[0.01], found.position])
    _, expected, _ = lsim(filter_of_lag, position, 1e-4 * np.arange(len(position)), X0=[0.01])
    assert found.measured_position == pytest.approx(expected[1:], abs=1e-8)
    slope = np.gradient(found.measured_position, 1e-4)
    assert found.measured_velocity[2:-2] == pytest.approx(slope[2:-2], abs=2e-3)


@pytest.mark.parametrize(("late_a", "late_b"), [(1e-6, 1e-3), (4e-3, 0.0), (0.02, 1.0)])
def test_each_pressure_sensor_s_lag_is_a_first_order_filter_of_its_own(late_a: float, late_b: float) -> None:
    found = run({"pressure_sensor_lag.time_constant_a": late_a, "pressure_sensor_lag.time_constant_b": late_b})
    for name, time_constant in (("pressure_a", late_a), ("pressure_b", late_b)):
        pressure = np.concatenate([[1.05e7], getattr(found, name)])
        expected = pressure
        if time_constant > 0.0:
            filter_of_lag = StateSpace([[-1.0 / time_constant]], [[1.0 / time_constant]], [[1.0]], [[0.0]])
            _, expected, _ = lsim(filter_of_lag, pressure, 1e-4 * np.arange(len(pressure)), X0=[1.05e7])
        assert getattr(found, f"measured_{name}") == pytest.approx(expected[1:], abs=1.0)


def test_a_late_pressure_is_late_with_its_gain_and_offset() -> None:
    """A linear filter passes both: the filtered pressure is shown scaled and shifted, once the start is past."""
    lag = {"pressure_sensor_lag.time_constant_a": 5e-3}
    affine = {"pressure_sensor_scale.ratio_a": 0.1, "pressure_sensor_bias.bias_a": 2e5}
    plain, found = run(lag), run(lag | affine)
    late = slice(1000, None)  # 20 time constants
    expected = 1.1 * plain.measured_pressure_a + 2e5
    assert found.measured_pressure_a[late] == pytest.approx(expected[late], abs=0.1)


def test_play_holds_the_measured_position_until_it_is_taken_up() -> None:
    found = run({"position_sensor_backlash.half_width": 3e-4})
    held, expected = 0.01, []
    for position in found.position:
        if abs(position - held) > 3e-4:
            held = position - np.copysign(3e-4, position - held)
        expected.append(held)
    assert found.measured_position == pytest.approx(np.array(expected), rel=1e-12)
    still = np.diff(found.measured_position) == 0.0
    assert 0.05 < np.mean(still) < 0.5
    assert np.all(found.measured_velocity[1:][still] == 0.0)
    assert np.array_equal(found.measured_velocity[1:][~still], found.velocity[1:][~still])


def test_scale_multiplies_position_and_velocity() -> None:
    found = run({"position_sensor_scale.ratio": 0.03})
    assert found.measured_position == pytest.approx(1.03 * found.position, rel=1e-14)
    assert found.measured_velocity == pytest.approx(1.03 * found.velocity, rel=1e-14)


def test_a_scaled_position_is_that_of_another_plant() -> None:
    """s x obeys the plant's equations with gain, leakage and volumes times s, and mass, damping and spring over s."""
    s, plant = 1.04, nominal_values()
    line = plant["line_volume"] / plant["piston_area"]
    times = {name: s * plant[name] for name in ("valve_gain", "internal_leakage")}
    over = {name: plant[name] / s for name in ("moving_mass", "damping_coefficient", "spring_stiffness")}
    stroke = {"actuator_displacement": s * plant["actuator_displacement"] + (s - 1.0) * line}
    other = Plant({**times, **over, **stroke}, initial_position=s * 0.01).run(VOLTAGES)
    found = run({"position_sensor_scale.ratio": s - 1.0})
    assert other.measured_position == pytest.approx(found.measured_position, abs=1e-9)
    assert other.pressure_a == pytest.approx(found.pressure_a, rel=1e-6)
    assert other.pressure_b == pytest.approx(found.pressure_b, rel=1e-6)


def test_bias_is_added_to_each_pressure() -> None:
    found = run({"pressure_sensor_bias.bias_a": 2e5, "pressure_sensor_bias.bias_b": -1e5})
    assert found.measured_pressure_a == pytest.approx(found.pressure_a + 2e5)
    assert found.measured_pressure_b == pytest.approx(found.pressure_b - 1e5)


def test_sensors_without_effects_say_what_is() -> None:
    found = Plant().run(VOLTAGES)
    assert np.array_equal(found.measured_position, found.position)
    assert np.array_equal(found.measured_velocity, found.velocity)
    assert np.array_equal(found.measured_pressure_a, found.pressure_a)
    assert np.array_equal(found.measured_pressure_b, found.pressure_b)


def test_gain_and_offset_of_the_pressure_sensors_add_up() -> None:
    scale = {"pressure_sensor_scale.ratio_a": 0.1, "pressure_sensor_scale.ratio_b": -0.05}
    found = run({**scale, "pressure_sensor_bias.bias_a": 2e5})
    assert found.measured_pressure_a == pytest.approx(1.1 * found.pressure_a + 2e5, rel=1e-12)
    assert found.measured_pressure_b == pytest.approx(0.95 * found.pressure_b, rel=1e-12)


def test_an_offset_zero_shifts_the_position_and_no_speed() -> None:
    found = run({"position_sensor_offset.offset": 0.02, "position_sensor_scale.ratio": 0.1})
    assert found.measured_position == pytest.approx(1.1 * found.position + 0.02, abs=1e-12)
    assert found.measured_velocity == pytest.approx(1.1 * found.velocity, abs=1e-12)


ZEROS = [(effect.id, name, channel) for effect in effects() for name, channel in effect.zeros]


@pytest.mark.parametrize(("effect", "name", "channel"), ZEROS, ids=lambda name: name)
def test_what_is_said_to_be_a_zero_shifts_its_channel_and_no_other(effect: str, name: str, channel: str) -> None:
    size = next(row.typical for one in effects() if one.id == effect for row in one.parameters if row.name == name)
    found = run({f"{effect}.{name}": size})
    for other in ("position", "velocity", "pressure_a", "pressure_b"):
        shift = size if other == channel else 0.0
        assert getattr(found, f"measured_{other}") == pytest.approx(getattr(found, other) + shift, rel=1e-12)
