"""The twin beside the simulator, on the same command over DDS."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import Rig
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from eha_core.recording import read_recording
from eha_interfaces.srv import Step

SIM = ("time_mode:=lockstep", "start_paused:=true", "moving_mass:=11.0", "coulomb_friction.force:=250.0")
REFERENCE = ("lockstep:=true", "signal:=multisine", "multisine.amplitude:=0.12", "multisine.lowest:=0.3")


def test_the_twin_names_the_equation_the_stamp_and_the_cause_and_records_it(rig: Rig, tmp_path: Path) -> None:
    model = tmp_path / "fitted.yaml"
    model.write_text("eha_sim:\n  ros__parameters:\n    moving_mass: 11.0\n    coulomb_friction.force: 250.0\n")
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim(*SIM)
    snapshots = ("snapshot_before:=2.0", "snapshot_after:=0.5", f"snapshot_folder:={tmp_path / 'snapshots'}")
    twin = rig.start("twin", f"model:={model}", "diagnostics_rate:=10.0", *snapshots)
    rig.client_ready("eha_twin/get_parameters")
    rig.start("reference", *REFERENCE)
    rig.client_ready("eha_reference/reset")
    reports, heard = rig.diagnostics("eha_twin"), rig.hear(JointState, "joint_states")
    rig.wait(lambda: reports, "a report of the twin")
    rig.spin(0.5)
    assert rig.call(Step, "eha_sim/step", steps=40_000).success
    rig.wait(lambda: heard and heard[-1].header.stamp.sec == 4, "four seconds", 60)
    rig.wait(lambda: reports[-1]["windows"] == "3", "three windows")
    compared = [report for report in reports if report["windows"] != "0"]  # before, nodes start, which may take long
    assert {(report["level"], report["message"]) for report in compared} == {(str(b"\x00"), "running")}
    assert float(reports[-1]["times the noise: force balance"]) < 2.0
    leakage = Parameter("internal_leakage", value=5e-11).to_parameter_msg()
    assert rig.call(SetParameters, "eha_sim/set_parameters", parameters=[leakage]).results[0].successful
    assert rig.call(Step, "eha_sim/step", steps=20_000).success
    rig.wait(lambda: reports[-1]["windows"] == "5", "two more windows")
    warned = reports[-1]
    assert warned["level"] == str(b"\x01")
    assert warned["message"].startswith("chamber ") and "times the noise since" in warned["message"]
    assert float(warned["departs since: chamber A"]) == pytest.approx(4.0, abs=0.1)
    assert float(warned["window_end"]) == pytest.approx(5.2, abs=0.01)
    rig.wait(lambda: "cause" in reports[-1], "the likely cause", 60)
    assert reports[-1]["cause"] == "internal_leakage" and reports[-1]["cannot be distinguished from"] == ""
    assert "; likely cause: internal leakage, " in reports[-1]["message"]
    value, _, deviation, unit = reports[-1]["size: internal_leakage"].split(maxsplit=3)
    assert unit == "l/min per MPa" and abs(float(value) - 3.0) < 2.0 * float(deviation)  # 5e-11 m^3/(s Pa)
    assert rig.call(Step, "eha_sim/step", steps=12_000).success
    rig.wait(lambda: "snapshot" in reports[-1], "the snapshot", 60)
    assert read_recording(reports[-1]["snapshot"]).duration == pytest.approx(2.5, abs=0.01)
    assert "likely cause: internal leakage" in twin.output and reports[-1]["snapshot"] in twin.output


def test_a_sensor_that_freezes_is_reported_as_frozen_and_no_equation_departs(rig: Rig) -> None:
    """Four seconds of a piston at rest under noise of 20 um; the last repeat one value."""
    rig.start("twin", "diagnostics_rate:=10.0")
    rig.client_ready("eha_twin/get_parameters")
    reports = rig.diagnostics("eha_twin")
    sensor = rig.node.create_publisher(JointState, "joint_states", 3000)
    rig.wait(sensor.get_subscription_count, "the twin's subscription")
    noise = 20e-6 * np.random.default_rng(1).standard_normal(2000)
    noise[1050:] = noise[1050]
    for number, position in enumerate(noise.tolist()):
        message = JointState(name=["piston"], position=[position])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(2_000_000 * number, 1_000_000_000)
        sensor.publish(message)
    rig.wait(lambda: reports and reports[-1].get("windows") == "3", "three windows")
    assert reports[-1]["message"] == "position is frozen since 2.200 s"
    assert not any("departs" in name for name in reports[-1])


def test_a_folder_for_snapshots_that_cannot_be_made_ends_in_one_line(rig: Rig, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    process = rig.start("twin", f"snapshot_folder:={tmp_path / 'file' / 'folder'}")
    assert process.wait() == 2
    assert process.output.count("\n") == 1 and "file/folder: cannot be made" in process.output


def test_a_model_that_cannot_be_read_ends_in_one_line(rig: Rig) -> None:
    process = rig.start("twin", "model:=/nowhere/fitted.yaml")
    assert process.wait() == 2
    assert process.output.count("\n") == 1 and "/nowhere/fitted.yaml" in process.output
