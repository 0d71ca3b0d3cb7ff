"""The monitor: tracking paired by stamp, and recordings that outlive whatever happens to it."""

from __future__ import annotations

import math
import resource
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from conftest import NodeProcess, Rig
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from eha_core.parameters import nominal_values
from eha_core.recording import read_recording
from eha_interfaces.msg import TrackingError


def joint_state(stamp: float, position: float) -> JointState:
    message = JointState(name=["piston"], position=[position], velocity=[0.0])
    message.header.stamp.sec = int(stamp)
    message.header.stamp.nanosec = round((stamp - int(stamp)) * 1e9)
    return message


def recording_of(folder: Path) -> Path:
    (path,) = folder.glob("*.mcap")
    return path


def is_recorded(rig: Rig, topic: str) -> bool:
    return any(info.node_name == "eha_monitor" for info in rig.node.get_subscriptions_info_by_topic(topic))


def start_monitor(rig: Rig, *parameters: str, **options: object) -> NodeProcess:
    monitor = rig.start("monitor", f"directory:={rig.folder}", *parameters, **options)
    rig.client_ready("eha_monitor/reset")
    return monitor


def test_errors_are_paired_by_stamp_and_not_by_arrival(rig: Rig) -> None:
    reference = rig.node.create_publisher(JointState, "reference", 100)
    measured = rig.node.create_publisher(JointState, "joint_states", 100)
    start_monitor(rig, "window:=0.1")
    rig.wait(lambda: reference.get_subscription_count() and measured.get_subscription_count(), "the monitor")
    heard = rig.hear(TrackingError, "tracking_error")
    rig.spin(0.3)
    times = np.arange(400) * 0.002 + 5.0
    desired, actual = np.sin(times), np.sin(times) + 1e-3 * np.cos(7 * times)
    for block in range(0, 400, 20):  # the measured values of each block come before their references
        for index in range(block, block + 20):
            measured.publish(joint_state(times[index], actual[index]))
        for index in range(block, block + 20):
            reference.publish(joint_state(times[index], desired[index]))
        rig.spin(0.02)
    rig.wait(lambda: heard and heard[-1].sample_count >= 399, "the pairs")
    rig.spin(0.2)
    count, error = heard[-1].sample_count, actual - desired
    assert heard[-1].rmse == pytest.approx(math.sqrt(np.mean(error[:count] ** 2)), rel=1e-6)
    assert heard[-1].largest_error == pytest.approx(np.abs(error[:count]).max(), rel=1e-6)
    assert heard[-1].rmse_window == pytest.approx(math.sqrt(np.mean(error[count - 50 : count] ** 2)), rel=0.05)
    assert rig.call(Trigger, "eha_monitor/reset").success
    measured.publish(joint_state(6.0, 0.5))
    reference.publish(joint_state(6.0, 0.25))
    measured.publish(joint_state(6.002, 0.5))
    reference.publish(joint_state(6.002, 0.25))
    rig.wait(lambda: heard[-1].sample_count < 10, "the count after the reset")
    assert heard[-1].rmse == pytest.approx(0.25, rel=1e-9)


def test_positions_without_a_reference_are_named(rig: Rig) -> None:
    reference = rig.node.create_publisher(JointState, "reference", 100)
    measured = rig.node.create_publisher(JointState, "joint_states", 100)
    start_monitor(rig, "record:=false", "diagnostics_rate:=2.0")
    reports = rig.diagnostics("eha_monitor")
    rig.wait(lambda: reference.get_subscription_count() and measured.get_subscription_count(), "the monitor")
    for tick in range(100):  # the reference begins with the fortieth position
        measured.publish(joint_state(5.0 + 0.002 * tick, 0.0))
        if tick >= 40:
            reference.publish(joint_state(5.0 + 0.002 * tick, 0.0))
        rig.spin(0.002)
    rig.wait(lambda: any("have no reference" in report["message"] for report in reports), "the warning", 10)
    rig.wait(lambda: reports[-1]["samples"] == "60" and reports[-1]["unpaired"] == "40", "the counts", 10)
    assert rig.wait(lambda: reports[-1]["message"] == "running", "the next report, with nothing new missing", 10)


def test_a_killed_recorder_leaves_a_file_that_lacks_one_second_at_most(rig: Rig) -> None:
    rig.start_sim()
    monitor = start_monitor(rig)
    rig.wait(lambda: is_recorded(rig, "joint_states"), "the monitor's subscriptions")
    rig.command(0.01, seconds=3.0)
    monitor.process.send_signal(signal.SIGKILL)
    killed = time.time_ns()
    monitor.wait()
    path = recording_of(rig.folder)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        last, topics = 0, set()
        for _, channel, message in reader.iter_messages():
            last = max(last, message.log_time)
            topics.add(channel.topic.removeprefix(f"{rig.namespace}/"))
    assert killed - last < 1_000_000_000
    assert {"voltage_command", "joint_states", "state", "chamber_a/pressure", "internal_leakage"} <= topics
    channels = read_recording(path).channels
    assert channels["voltage_command"].values.max() == pytest.approx(0.01)
    assert channels["pressure_a"].values[0] == pytest.approx(1.05e7, rel=0.01)


def test_the_recording_is_read_by_others_and_keeps_the_parameters(rig: Rig) -> None:
    rig.start_sim("moving_mass:=12.5")
    monitor = start_monitor(rig)
    rig.wait(lambda: is_recorded(rig, "joint_states"), "the monitor's subscriptions")
    rig.command(0.01, seconds=1.5)
    assert monitor.end() == 0
    path = recording_of(rig.folder)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        (record,) = (record for record in reader.iter_metadata() if record.name == "eha_parameters")
    kept = {name: float(value) for name, value in record.metadata.items()}
    assert kept == {**nominal_values(), "moving_mass": 12.5}
    with AnyReader([path]) as bag:
        chosen = [item for item in bag.connections if item.topic == f"{rig.namespace}/joint_states"]
        positions = [bag.deserialize(raw, item.msgtype).position[0] for item, _, raw in bag.messages(chosen)]
    assert len(positions) > 400
    assert positions[-1] > 0.0


def test_every_topic_of_the_simulator_can_be_recorded(rig: Rig) -> None:
    """One of them has a type that ROS 2 has from Kilted on and no type store knows."""
    commands = pytest.importorskip("control_msgs.msg")
    rig.node.create_publisher(commands.JointCommand, "joint_command/effort", 10)
    rig.start_sim()
    monitor = start_monitor(rig, "diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_monitor")
    rig.wait(lambda: is_recorded(rig, f"{rig.namespace}/joint_command/effort"), "the recorder on the topic", 20)
    rig.wait(lambda: len(reports) > 2, "reports")
    assert "is not recorded" not in monitor.output
    assert not any("is not recorded" in report["message"] for report in reports)


def test_start_stop_split(rig: Rig) -> None:
    voltage = rig.commands
    start_monitor(rig, "record:=false", "name:=run")
    refused = rig.call(Trigger, "eha_monitor/stop")
    assert not refused.success and "nothing is being recorded" in refused.message
    rig.wait(lambda: voltage.get_subscription_count(), "the monitor's subscription")
    assert rig.call(Trigger, "eha_monitor/start").message == str(rig.folder / "run.mcap")
    for volts in (1.0, 2.0):
        voltage.publish(Float64(data=volts))
        rig.spin(0.3)
    second = rig.call(Trigger, "eha_monitor/split")
    assert second.success
    voltage.publish(Float64(data=3.0))
    rig.spin(0.3)
    assert rig.call(Trigger, "eha_monitor/stop").message == second.message
    voltage.publish(Float64(data=4.0))
    rig.spin(0.3)
    heard = []
    for path in (rig.folder / "run.mcap", Path(second.message)):
        with AnyReader([path]) as bag:
            chosen = [item for item in bag.connections if item.topic.endswith("voltage_command")]
            heard.append([bag.deserialize(raw, item.msgtype).data for item, _, raw in bag.messages(chosen)])
    assert heard == [[1.0, 2.0], [3.0]]


def test_an_unwritable_folder_is_reported_and_monitoring_goes_on(rig: Rig) -> None:
    (rig.folder / "file").write_text("not a folder")
    monitor = rig.start("monitor", f"directory:={rig.folder / 'file' / 'bags'}", "diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_monitor")
    rig.wait(lambda: reports and "not recording" in reports[-1]["message"], "the failure in /diagnostics")
    assert str(rig.folder / "file") in monitor.output
    assert "Traceback" not in monitor.output
    assert_it_monitors(rig)


def test_a_full_disk_is_reported_and_monitoring_goes_on(rig: Rig) -> None:
    def small_disk() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    rig.start_sim()
    monitor = start_monitor(rig, "diagnostics_rate:=5.0", preexec_fn=small_disk)
    reports = rig.diagnostics("eha_monitor")
    rig.wait(lambda: reports and "not recording" in reports[-1]["message"], "the failure in /diagnostics")
    assert monitor.process.poll() is None
    assert "Traceback" not in monitor.output
    assert len(read_recording(recording_of(rig.folder)).channels["position"].values) > 100


def test_a_file_that_is_removed_is_noticed_and_the_recording_goes_on_in_the_next(rig: Rig) -> None:
    rig.start_sim()
    monitor = start_monitor(rig, "name:=run", "diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_monitor")
    rig.wait(lambda: is_recorded(rig, "joint_states"), "the monitor's subscriptions")
    (rig.folder / "run.mcap").unlink()
    rig.wait(lambda: reports and "the file was removed" in reports[-1]["message"], "the loss in /diagnostics")
    rig.wait(lambda: (rig.folder / "run.mcap").is_file(), "the next recording")
    rig.spin(0.5)
    assert monitor.end() == 0
    assert "recording goes on in" in monitor.output
    recording = read_recording(rig.folder / "run.mcap")
    assert recording.damaged is None and len(recording.channels["position"].values) > 50


@pytest.fixture
def hangup_as_on_a_terminal() -> Iterator[None]:
    """Processes started inherit what a terminal gives them, also where the tests run under nohup."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.usefixtures("hangup_as_on_a_terminal")
def test_a_closed_terminal_ends_the_recording_properly_and_a_kill_is_told_at_the_next_start(rig: Rig) -> None:
    rig.start_sim()
    for number, name in ((signal.SIGHUP, "closed"), (signal.SIGKILL, "killed")):
        monitor = start_monitor(rig, f"name:={name}")
        rig.wait(lambda: is_recorded(rig, "joint_states"), "the monitor's subscriptions")
        rig.spin(0.5)
        assert "was not finished" not in monitor.output
        monitor.end(number)
        rig.wait(lambda: not is_recorded(rig, "joint_states"), "the monitor to be gone")
    assert read_recording(rig.folder / "closed.mcap").damaged is None
    assert "was not finished" in str(read_recording(rig.folder / "killed.mcap").damaged)
    again = start_monitor(rig, "name:=again")
    rig.wait(lambda: f"{rig.folder / 'killed.mcap'} was not finished" in again.output, "what the last one left")


def assert_it_monitors(rig: Rig) -> None:
    reference = rig.node.create_publisher(JointState, "reference", 100)
    measured = rig.node.create_publisher(JointState, "joint_states", 100)
    rig.wait(lambda: reference.get_subscription_count() and measured.get_subscription_count(), "the monitor")
    heard = rig.hear(TrackingError, "tracking_error")
    rig.spin(0.3)
    for index in range(20):
        measured.publish(joint_state(1.0 + index * 0.01, 0.5))
        reference.publish(joint_state(1.0 + index * 0.01, 0.25))
    rig.wait(lambda: heard, "a tracking error")
    assert heard[-1].error == pytest.approx(0.25)


def test_the_file_says_what_it_covers_of_each_topic(rig: Rig) -> None:
    """A command that pauses for a second is recorded with that gap."""
    monitor = start_monitor(rig)
    rig.wait(lambda: is_recorded(rig, f"{rig.namespace}/voltage_command"), "the monitor")
    rig.command(1.0, 0.2)
    rig.spin(1.0)
    rig.command(1.0, 0.2)
    rig.spin(0.3)
    assert monitor.end() == 0
    with recording_of(rig.folder).open("rb") as stream:
        (record,) = [one for one in make_reader(stream).iter_metadata() if one.name == "eha_coverage"]
    coverage = dict(part.split("=") for part in record.metadata[f"{rig.namespace}/voltage_command"].split())
    assert int(coverage["count"]) == 40
    assert (int(coverage["gap_end"]) - int(coverage["gap_start"])) / 1e9 == pytest.approx(1.0, abs=0.3)
