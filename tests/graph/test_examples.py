"""The examples as a user runs them: the demonstrations in lockstep, and a position controller of one's own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import NodeProcess, Rig
from mcap.reader import make_reader
from sensor_msgs.msg import JointState

from eha_core.plant import Plant
from eha_core.recording import read_recording

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
LEVELS = (1e-12, 1e-11, 1e-10, 1e-9)
CONCEALED = {"moving_mass": 11.0, "coulomb_friction.force": 250.0}


def test_the_demonstration_equals_the_plant_to_rounding(tmp_path: Path) -> None:
    # Another domain than the session's: the demonstration's nodes bear no namespace.
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    command = [sys.executable, str(EXAMPLES / "paper_demo.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=180, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    levels = json.loads((tmp_path / "rmse.json").read_text())["levels"]
    assert [level["internal_leakage"] for level in levels] == list(LEVELS)
    command_voltage = np.repeat(8.4e-3 * np.sin(2 * np.pi * np.arange(5000) * 0.002), 20)
    leaking, tight = Plant(), Plant({"internal_leakage": 0.0})
    for number, level in enumerate(levels):
        leaking.set_parameters({"internal_leakage": LEVELS[number]})
        error = leaking.run(command_voltage, every=20).position - tight.run(command_voltage, every=20).position
        samples = np.append(0.0, error) if number == 0 else error
        assert level["rmse"] == pytest.approx(np.sqrt(np.mean(samples**2)), rel=1e-9)
    assert [level["ratio"] for level in levels[:3]] == pytest.approx([1.0, 1.0, 1.0], abs=0.01)
    with (tmp_path / "demo.mcap").open("rb") as stream:
        leakage = [
            (message.log_time, np.frombuffer(message.data[4:], "<f8")[0])
            for _, _, message in make_reader(stream).iter_messages(topics=["/internal_leakage"])
        ]
    assert leakage == [(number * 10_000_000_000, value) for number, value in enumerate(LEVELS)]
    assert len(list((tmp_path / "figures").glob("*.png"))) == 3


@pytest.mark.timeout(400)
def test_what_is_concealed_in_a_rig_is_named_and_simulated(tmp_path: Path) -> None:
    environment = {**os.environ, "ROS_DOMAIN_ID": str(int(os.environ["ROS_DOMAIN_ID"]) - 1)}
    command = [sys.executable, str(EXAMPLES / "concealed_demo.py"), "--out", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=390, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text())
    assert document["verdict"] == "missing_physics"
    (effect,) = document["effects"]
    assert effect["id"] == "coulomb_friction"
    assert effect["parameters"]["force"]["value"] == pytest.approx(250.0, rel=0.01)
    masses = [row["fitted"] for row in document["parameters"] if row["name"] == "moving_mass"]
    assert masses == pytest.approx([11.0], rel=0.01)
    errors = json.loads((tmp_path / "before_after.json").read_text())
    for name in ("position", "pressure_a", "pressure_b"):
        assert errors["fitted"][name] < 0.01 * errors["nominal"][name]
    # What the two errors are measured between is what the plant does, with and without what was concealed.
    volts = read_recording(tmp_path / "rig.mcap").channels["voltage_command"]
    rig, nominal = (Plant(given).run(np.repeat(volts.values[:6000], 20), every=20) for given in (CONCEALED, {}))
    expected = np.sqrt(np.sum((rig.position - nominal.position) ** 2) / 6001)
    assert errors["nominal"]["position"] == pytest.approx(expected, rel=1e-9)


def test_a_demonstration_that_fails_says_so_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("in the way")
    command = [sys.executable, str(EXAMPLES / "concealed_demo.py"), "--out", str(tmp_path / "out")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("concealed_demo: ") and done.stderr.count("\n") == 1


def test_a_controller_of_ones_own_follows_a_position(rig: Rig) -> None:
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("time_mode:=lockstep")
    rig.start("reference", "mode:=position", "lockstep:=true", "signal:=sine", "sine.amplitude:=0.01")
    log = rig.folder / "controller.log"
    gains = ["-p", "gain:=10.0", "-p", "feedforward:=0.8"]
    command = [str(EXAMPLES / "position_controller.py"), "--ros-args", "-r", f"__ns:={rig.namespace}", *gains]
    rig.processes.append(NodeProcess(log, [sys.executable, *command]))
    measured, references = rig.hear(JointState, "joint_states"), rig.hear(JointState, "reference")
    rig.wait(lambda: len(measured) > 2000 and len(references) > 2000, "four seconds of simulated time")
    by_stamp = {(item.header.stamp.sec, item.header.stamp.nanosec): item.position[0] for item in references}
    errors = [
        item.position[0] - by_stamp[(item.header.stamp.sec, item.header.stamp.nanosec)]
        for item in measured[1000:2000]
        if (item.header.stamp.sec, item.header.stamp.nanosec) in by_stamp
    ]
    assert len(errors) > 900
    assert np.abs(errors).max() < 0.001  # a tenth of the amplitude
