"""The investigate node on the simulator: a whole investigation, and everything that stops its motion."""

from __future__ import annotations

import json
import os
import pty
import signal
from pathlib import Path

import pytest
from conftest import NodeProcess, Rig
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from eha_core.recording import read_recording

COMMAND = "command:=multisine:amplitude=0.06,lowest=0.3,highest=8.0,count=16,period=20.0,seed=5"
SLOW = "command:=sine:amplitude=0.05,frequency=0.1"


def investigate(rig: Rig, *parameters: str, **options: object) -> NodeProcess:
    rig.node.destroy_publisher(rig.commands)
    return rig.start("investigate", f"directory:={rig.folder / 'found'}", "jobs:=1", *parameters, **options)


def test_friction_is_found_recorded_and_shown(rig: Rig) -> None:
    rig.start("sim", "time_mode:=lockstep", "coulomb_friction.force:=30.0")
    node = investigate(rig, "lockstep:=true", "feedback_timeout:=60.0", COMMAND, "command_duration:=3.0")
    assert node.wait(400) == 0, node.output
    assert "Ended: one set remains" in node.output and "Named: Coulomb friction (force " in node.output
    folder = rig.folder / "found"
    document = json.loads((folder / "investigation.json").read_text())
    (step,) = document["steps"]
    assert [one["effects"] for one in step["sets"]] == [["coulomb_friction"]]
    assert "one set remains" in (folder / "investigation.html").read_text()
    assert (folder / "diagnosis" / "report.html").is_file()
    channels = read_recording(folder / "test_1.mcap").channels
    command, position = channels["voltage_command"], channels["position"]
    assert 1500 <= len(command.values) <= 1502 and command.values[-1] == 0.0
    assert abs(len(position.values) - len(command.values)) <= 2


def test_a_limit_in_sight_stops_the_motion_first(rig: Rig) -> None:
    limits = rig.folder / "limits.yaml"
    limits.write_text("position: 0.004\n")
    rig.start_sim("time_mode:=lockstep")
    states, commands = rig.hear(JointState, "joint_states"), []
    rig.node.create_subscription(Float64, "voltage_command", commands.append, 1000)
    node = investigate(rig, "lockstep:=true", "feedback_timeout:=60.0", f"limits:={limits}", SLOW)
    rig.wait(lambda: node.process.poll() is not None, "the end of the node")
    assert node.process.returncode == 1
    assert "eha_investigate: position " in node.output and "the limit of 4.00 mm is in sight" in node.output
    assert commands[-1].data == 0.0 and commands[-2].data > 0.0
    assert 0.003 < states[-1].position[0] < 0.004
    assert "the motion was stopped" in (rig.folder / "found" / "investigation.html").read_text()
    assert read_recording(rig.folder / "found" / "test_1.mcap").channels["voltage_command"].values[-1] == 0.0


def test_a_rig_that_falls_silent_is_stopped(rig: Rig) -> None:
    sim = rig.start_sim()
    states = rig.hear(JointState, "joint_states")
    commands: list[Float64] = []
    rig.node.create_subscription(Float64, "voltage_command", commands.append, 1000)
    node = investigate(rig, "feedback_timeout:=2.0", SLOW)
    rig.wait(lambda: len(commands) > 100, "the motion")
    assert states
    sim.end(signal.SIGKILL)
    rig.wait(lambda: node.process.poll() is not None, "the end of the node")
    assert node.process.returncode == 1
    assert "joint_states is lost: nothing for 2" in node.output or "pressure is lost: nothing for 2" in node.output
    assert commands[-1].data == 0.0


def test_any_key_stops_the_motion_first(rig: Rig) -> None:
    rig.start_sim()
    commands: list[Float64] = []
    rig.node.create_subscription(Float64, "voltage_command", commands.append, 1000)
    terminal, end = pty.openpty()
    node = investigate(rig, "feedback_timeout:=20.0", SLOW, stdin=end, start_new_session=True,
                       preexec_fn=lambda: take_terminal(end))  # fmt: skip
    rig.wait(lambda: len(commands) > 100, "the motion")
    os.write(terminal, b" ")
    rig.wait(lambda: node.process.poll() is not None, "the end of the node")
    assert (node.process.returncode, commands[-1].data) == (1, 0.0)
    assert "eha_investigate: a key was pressed; the recording up to then is " in node.output


def take_terminal(descriptor: int) -> None:
    """Make a terminal the one that this session is controlled from."""
    import fcntl
    import termios

    fcntl.ioctl(descriptor, termios.TIOCSCTTY, 0)


@pytest.mark.parametrize(
    ("parameter", "text"),
    [
        ("limits:=/nowhere/limits.yaml", "limits file /nowhere/limits.yaml"),
        ("channels:=position,force", "channels: there is no channel 'force'"),
    ],
)
def test_what_cannot_be_used_ends_in_one_line(rig: Rig, tmp_path: Path, parameter: str, text: str) -> None:
    node = rig.start("investigate", f"directory:={tmp_path / 'found'}", parameter)
    assert node.wait() == 2
    (line,) = (line for line in node.output.splitlines() if line.startswith("eha_investigate: "))
    assert text in line and "Traceback" not in node.output
