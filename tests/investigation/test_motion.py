"""A test begins at mid stroke, whatever the piston's place, and lasts as long as it should."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_rig import PERIOD, SimulatedRig

from eha_core.control.linear_model import velocity_gain
from eha_core.diagnosis.experiment.command_signal import CommandSignal
from eha_core.diagnosis.experiment.limits import Limits
from eha_core.investigation import MotionStopped, VoltageTest, from_mid_stroke
from eha_core.investigation.motion import NEAR, PATIENCE
from eha_core.parameters import nominal_values

LIMITS = Limits(position=0.06, speed=0.3, pressure=25e6, voltage=1.0)
SINE = VoltageTest(CommandSignal("sine", {"amplitude": 0.05, "frequency": 2.0}), 1.5, "a look")


def motion(limits: Limits = LIMITS):
    return from_mid_stroke(SINE, velocity_gain(nominal_values()), limits)


def test_in_mid_stroke_the_test_begins_at_once() -> None:
    rig = SimulatedRig({}, LIMITS)
    recording = rig.run(motion(), "test_1")
    command = recording.channels["voltage_command"]
    played = 0.05 * np.sin(2.0 * np.pi * 2.0 * command.time)
    np.testing.assert_allclose(command.values[:-1], played[:-1], atol=1e-9)
    assert command.time[-1] == pytest.approx(1.5) and command.values[-1] == 0.0


@pytest.mark.parametrize("start", [0.04, -0.04])
def test_from_elsewhere_the_piston_first_comes_back_slowly(start: float) -> None:
    rig = SimulatedRig({}, LIMITS, position=start)
    channels = rig.run(motion(), "test_1").channels
    time, position = channels["position"].time, channels["position"].values
    began = time[np.argmax(np.abs(position) < NEAR * 0.06)]
    assert 0.5 < began < 3.0
    assert time[-1] == pytest.approx(began + 1.5, abs=2.0 * PERIOD)
    back = time < began
    assert np.all(np.sign(channels["voltage_command"].values[back]) == -np.sign(start))
    assert np.max(np.abs(np.diff(position[back][::10]) / (10.0 * PERIOD))) < 0.6 * LIMITS.speed


def test_a_valve_that_brings_it_nowhere_does_not_keep_the_test_from_beginning() -> None:
    voltages = [motion()(elapsed, 0.04) for elapsed in (0.0, PATIENCE - 0.1)]
    assert all(voltage < 0.0 for voltage in voltages)
    waited = motion()
    assert waited(PATIENCE, 0.04) == 0.0 and waited(PATIENCE + 1.5, 0.04) is None


def test_a_limit_in_sight_stops_with_zero_voltage_before_it_is_passed() -> None:
    limits = Limits(position=0.002, speed=0.3, pressure=25e6, voltage=1.0)
    rig = SimulatedRig({}, limits)
    with pytest.raises(MotionStopped, match=r"the limit of 2\.00 mm is in sight"):
        rig.run(from_mid_stroke(SINE, 1.0, limits), "test_1")
    assert rig.rows[0][-1][1] == 0.0
    assert abs(rig.position) < 0.002
    with pytest.raises(MotionStopped):
        rig.run(motion(), "test_2")
