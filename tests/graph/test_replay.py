"""Replay: `ros2 bag play` of a recording drives the simulator as the recorded commands did."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import NodeProcess, Rig

from eha_core.recording import read_recording
from eha_interfaces.msg import ActuatorState

SEARCHED = os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")])
ROS2 = shutil.which("ros2", path=SEARCHED)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds of a sine, simulated and recorded without a node.

    It begins with 0.3 s of rest: ROS 2's own player may send the first tenth of a second at once.
    """
    folder = tmp_path_factory.mktemp("recorded")
    times = np.arange(0.0, 2.3, 0.002)
    volts = np.where(times < 0.3, 0.0, 0.05 * np.sin(2 * np.pi * (times - 0.3)))
    table = np.column_stack([times, volts])
    np.savetxt(folder / "sine.csv", table, delimiter=",", header="time,voltage_command", comments="")
    command = ["--command", str(folder / "sine.csv"), "--out", str(folder / "sine.mcap")]
    subprocess.run([str(shutil.which("eha", path=SEARCHED)), "simulate", *command], check=True, capture_output=True)
    return folder / "sine.mcap"


def play(rig: Rig, recording: Path) -> NodeProcess:
    """Start playing the commands alone, into the test's namespace, once the simulator has been found."""
    topic = "/voltage_command"
    arguments = ["--topics", topic, "--remap", f"{topic}:={rig.namespace}{topic}", "--delay", "1.0"]
    player = NodeProcess(rig.folder / "player.log", [str(ROS2), "bag", "play", str(recording), *arguments])
    rig.processes.append(player)
    return player


def drive(rig: Rig, recording: Path, *parameters: str) -> list[ActuatorState]:
    """Play a recording to a simulator and return every state it published; none is lost by a test that falls behind."""
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim(*parameters)
    states = rig.hear(ActuatorState, "state", 20_000)
    if "time_mode:=lockstep" not in parameters:
        rig.wait(lambda: states, "the first state")  # what comes before that is taken all at once
    player = play(rig, recording)
    rig.wait(lambda: player.process.poll() is not None, "the end of the recording")
    assert player.process.returncode == 0, player.output
    return states


def test_in_lockstep_the_piston_goes_as_recorded_bit_for_bit(rig: Rig, recorded: Path) -> None:
    states = drive(rig, recorded, "time_mode:=lockstep")
    channels = read_recording(recorded).channels
    positions = channels["position"].values.tolist()
    rig.wait(lambda: len(states) >= len(positions), "a state for each that was recorded", 20)
    rig.spin(0.5)
    assert [state.position for state in states] == positions
    assert [state.voltage for state in states[1:]] == channels["voltage_command"].values.tolist()


def test_in_real_time_the_piston_goes_as_recorded(rig: Rig, recorded: Path) -> None:
    states = drive(rig, recorded)
    position = read_recording(recorded).channels["position"].values
    expected = position[np.flatnonzero(position)]

    def moved() -> list[float]:
        """Positions from the first on that a voltage has moved."""
        return [state.position for state in states if state.position != 0.0]

    rig.wait(lambda: len(moved()) >= len(expected), "a state for each that was recorded", 20)
    error = np.array(moved()[: len(expected)]) - expected
    assert np.ptp(expected) > 0.005
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.std(expected)
