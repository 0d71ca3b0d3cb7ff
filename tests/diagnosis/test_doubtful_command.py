"""A command with rests whose log ends at a value that it exceeded, or froze in a rest: only the plant shows it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made import recorded

from eha_core.diagnosis import diagnose
from eha_core.diagnosis.calibrate import calibrate_without_faulty_ends, is_at_noise
from eha_core.diagnosis.doubtful_command import without_doubtful_command
from eha_core.errors import RecordingError
from eha_core.health import DOUBTING, examine
from eha_core.identification.observation import observe
from eha_core.nominal import NominalModel
from eha_core.parameters import nominal_values
from eha_core.recording import Recording

RATE, DURATION = 500.0, 8.0


def moves(shape) -> np.ndarray:
    """Smooth or trapezoidal pulses of several heights [V], with rests between them."""
    heights = (0.5, -0.5, 0.5, -0.3, 0.2, -0.4, 0.45, -0.45)
    pulse, rest = shape(np.arange(120) / 120.0), np.zeros(50)
    return np.resize(np.concatenate([part for height in heights for part in (height * pulse, rest)]), 4000)


def smooth(way: np.ndarray) -> np.ndarray:
    return 16.0 * way**2 * (1.0 - way) ** 2


def trapezoid(way: np.ndarray) -> np.ndarray:
    return np.minimum(1.0, 4.0 * np.minimum(way, 1.0 - way))


def test_a_command_that_was_clipped_in_the_log_is_no_physics() -> None:
    made = recorded({"moving_mass": 10.0}, rate=RATE, duration=DURATION, voltage=moves(smooth))
    command = made.channels["voltage_command"]
    clipped = replace(command, values=np.minimum(command.values, 0.35))
    found = diagnose(replace(made, channels={**made.channels, "voltage_command": clipped}), nominal_values())
    assert found.verdict in ("consistent", "parameters") and not found.effects
    lost = np.zeros(len(command.time), dtype=bool)
    for _, fault in found.health:
        assert (fault.channel, fault.fault) == ("voltage_command", "saturated")
        lost |= (command.time >= fault.start) & (command.time <= fault.end)
    assert np.array_equal(lost, command.values >= 0.35)


@pytest.mark.parametrize(("name", "value"), [("flow_gain_asymmetry.ratio", 0.01), ("valve_null_offset.offset", 2e-5)])
def test_an_effect_is_not_taken_for_a_log_that_ends_at_the_flat_tops_of_a_command(name: str, value: float) -> None:
    made = recorded({name: value}, rate=RATE, duration=DURATION, voltage=moves(trapezoid))
    found = diagnose(made, nominal_values())
    assert [effect.id for effect in found.effects] == [name.partition(".")[0]]
    assert not found.health


def frozen(values: np.ndarray) -> np.ndarray:
    """Moves that are logged as a rest which begins in one and ends in the middle of a pulse."""
    return np.where((np.arange(len(values)) > 1155) & (np.arange(len(values)) < 1420), values[1155], values)


def test_a_command_that_froze_in_a_rest_is_no_physics() -> None:
    made = recorded({"moving_mass": 10.0}, rate=RATE, duration=DURATION, voltage=moves(smooth))
    command = made.channels["voltage_command"]
    log = replace(command, values=frozen(command.values))
    assert not examine(replace(made, channels={**made.channels, "voltage_command": log})).faults
    found = diagnose(replace(made, channels={**made.channels, "voltage_command": log}), nominal_values())
    assert found.verdict in ("consistent", "parameters") and not found.effects
    ((_, fault),) = found.health
    assert (fault.channel, fault.fault) == ("voltage_command", "frozen")
    assert fault.start <= command.time[1155] and fault.end == command.time[1419]


def test_an_effect_is_not_taken_for_a_log_that_froze_before_the_only_step_of_a_command() -> None:
    made = recorded({"valve_null_offset.offset": 2e-5}, rate=RATE, duration=DURATION, voltage=frozen(moves(smooth)))
    assert [fault.fault for fault in examine(made, DOUBTING).faults] == ["frozen"]
    found = diagnose(made, nominal_values())
    assert [effect.id for effect in found.effects] == ["valve_null_offset"]
    assert not found.health


def left_out(made: Recording) -> bool:
    """Whether a command's extremes are left out, where the nominal equations do not explain the whole."""
    model = NominalModel(nominal_values())
    seen, calibration = calibrate_without_faulty_ends([observe(made)], model)
    assert not is_at_noise(calibration.fitted)
    return without_doubtful_command([made], seen, calibration, model) is not None


def test_a_square_wave_that_leaps_to_its_extremes_was_not_clipped_there() -> None:
    """Of one half of it alone, other gains of the valve would explain what a valve of unequal gains does."""
    voltage = 0.03 * np.sign(np.sin(2.0 * np.pi * (np.arange(2000) / RATE + 1e-4)))
    made = recorded({"flow_gain_asymmetry.ratio": 0.05}, rate=RATE, duration=4.0, voltage=voltage)
    assert not examine(made, DOUBTING).faults
    assert not left_out(made)


def test_a_command_that_is_nearly_always_at_its_extreme_leaves_nothing_to_judge_by() -> None:
    ramp = np.linspace(0.0, 0.05, 20)
    pulse = np.concatenate([ramp, np.full(250, 0.05), ramp[::-1], np.zeros(10)])
    voltage = np.resize(np.concatenate([pulse, -pulse]), 1500)
    made = recorded({"valve_deadband.half_width": 1e-4}, rate=RATE, duration=3.0, voltage=voltage)
    with pytest.raises(RecordingError, match="almost nothing of position can be used"):
        observe(made, health=examine(made, DOUBTING))
    assert not left_out(made)
