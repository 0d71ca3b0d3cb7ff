"""What the writer leaves on disk, judged by the mcap and rosbags libraries, also after a kill and on a full disk."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from recordings import SECOND, START, piston_recording, write_piston
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability

from eha_core.errors import RecordingError
from eha_core.recording import OfferedQuality, RecordingWriter, encode, read_recording

FLOAT = "std_msgs/msg/Float64"


def messages_of(path: Path) -> list[tuple[str, int, bytes]]:
    with path.open("rb") as stream:
        return [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in make_reader(stream).iter_messages()
        ]


def test_the_mcap_library_reads_back_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    data = encode(FLOAT, {"data": 0.25})
    with RecordingWriter(path, {"moving_mass": 9.0, "coulomb_friction.force": 300.0}) as writer:
        writer.write("/a/voltage_command", FLOAT, data, START)
        writer.write("/a/voltage_command", FLOAT, data, START + 7)
    with path.open("rb") as stream:
        reader = make_reader(stream)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 2
        (schema,), (channel,) = summary.schemas.values(), summary.channels.values()
        assert (schema.name, schema.encoding, schema.data.strip()) == (FLOAT, "ros2msg", b"float64 data")
        assert channel.message_encoding == "cdr"
        assert channel.metadata["topic_type_hash"].startswith("RIHS01_")
        (metadata,) = reader.iter_metadata()
        assert metadata.name == "eha_parameters"
        assert {name: float(text) for name, text in metadata.metadata.items()} == {
            "moving_mass": 9.0,
            "coulomb_friction.force": 300.0,
        }
    assert messages_of(path) == [("/a/voltage_command", START, data), ("/a/voltage_command", START + 7, data)]


def test_the_rosbags_library_reads_back_typed_messages(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap", namespace="/rig")
    with AnyReader([path]) as reader:
        assert {connection.topic: connection.msgcount for connection in reader.connections} == {
            "/rig/voltage_command": 100,
            "/rig/joint_states": 100,
            "/rig/chamber_a/pressure": 100,
            "/rig/chamber_b/pressure": 100,
        }
        joints = [connection for connection in reader.connections if connection.topic == "/rig/joint_states"]
        decoded = [reader.deserialize(data, c.msgtype) for c, _, data in reader.messages(joints)]
    assert [message.name for message in decoded[:2]] == [["piston"], ["piston"]]
    np.testing.assert_array_equal([message.position[0] for message in decoded], np.arange(100) * 1e-6)
    assert decoded[42].header.stamp.sec * SECOND + decoded[42].header.stamp.nanosec == START + 42 * SECOND // 100


def test_nested_definitions_follow_rows_of_equal_signs(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap", count=1)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    text = next(schema.data.decode() for schema in summary.schemas.values() if "JointState" in schema.name)
    main, *parts = text.split("=" * 80 + "\n")
    assert "float64[] position" in main
    assert [part.splitlines()[0] for part in parts] == ["MSG: std_msgs/Header", "MSG: builtin_interfaces/Time"]


def test_the_offered_quality_is_kept_as_ros2_bag_keeps_it(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        latched = OfferedQuality(durability="transient_local", depth=1)
        writer.write_fields("/internal_leakage", FLOAT, {"data": 1e-12}, START, latched)
    with AnyReader([path]) as reader:
        (quality,) = reader.connections[0].ext.offered_qos_profiles
    assert (quality.durability, quality.depth) == (QosDurability.TRANSIENT_LOCAL, 1)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    (profile,) = yaml.safe_load(summary.channels[1].metadata["offered_qos_profiles"])
    assert profile["deadline"] == {"sec": 9223372036, "nsec": 854775807}
    assert profile["avoid_ros_namespace_conventions"] is False


def test_what_nothing_is_said_of_is_offered_as_ros2_does_by_default() -> None:
    """rmw_qos_profile_default of rmw/qos_profiles.h: reliable, volatile, the last ten."""
    (profile,) = yaml.safe_load(OfferedQuality().as_yaml())
    assert (profile["history"], profile["depth"]) == ("keep_last", 10)
    assert (profile["reliability"], profile["durability"]) == ("reliable", "volatile")


def test_messages_of_eha_interfaces_are_written_from_their_own_definition(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/state", "eha_interfaces/msg/ActuatorState", {"voltage": 0.5, "flow_a": 1e-5}, START)
    with AnyReader([path]) as reader:
        ((connection, _, data),) = reader.messages()
        message = reader.deserialize(data, connection.msgtype)
    assert (message.voltage, message.flow_a, message.position) == (0.5, 1e-5, 0.0)


def test_every_flush_leaves_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, flush_period=1e9)
    assert messages_of(path) == []
    for total in (3, 8):
        write_piston(writer, count=total - writer.message_count, topics=("voltage_command",))
        assert len(messages_of(path)) < total
        writer.flush()
        assert len(messages_of(path)) == total
        with AnyReader([path]) as reader:
            assert reader.message_count == total
        assert "was not finished" in str(read_recording(path).damaged)
    writer.close()
    assert len(messages_of(path)) == 8
    assert read_recording(path).damaged is None


def test_a_split_goes_on_in_a_file_that_stands_alone(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "run.mcap", {"moving_mass": 9.0}) as writer:
        write_piston(writer, count=10)
        assert writer.split() == tmp_path / "run_1.mcap"
        write_piston(writer, count=20)
    for name, count in (("run.mcap", 10), ("run_1.mcap", 20)):
        recording = read_recording(tmp_path / name)
        assert len(recording.channels["position"].time) == count
        assert recording.parameters == {"moving_mass": 9.0}


def test_an_existing_file_is_not_overwritten(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap")
    before = path.read_bytes()
    with pytest.raises(RecordingError, match=r"run\.mcap: exists already; choose"):
        RecordingWriter(path)
    assert path.read_bytes() == before


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(RecordingError, match=r"file/run\.mcap: cannot be written \(File exists: .*file\)"):
        RecordingWriter(tmp_path / "file" / "run.mcap")


def test_an_unknown_type_is_refused_and_the_rest_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        with pytest.raises(RecordingError, match="absent_msgs/msg/Nothing: no definition found; install absent_msgs"):
            writer.write("/x", "absent_msgs/msg/Nothing", b"\0\1\0\0", START)
        write_piston(writer, count=2)
    assert len(read_recording(path).channels["position"].time) == 2


def test_writing_after_the_end_is_an_error_and_closing_twice_is_not(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / "run.mcap")
    writer.close()
    writer.close()
    with pytest.raises(RecordingError, match="the recording is closed"):
        writer.write_fields("/x", FLOAT, {}, START)


KILLED = """
import sys, time
from eha_core.recording import RecordingWriter
writer = RecordingWriter(sys.argv[1])
while True:
    stamp = time.time_ns()
    header = {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}}
    writer.write_fields(
        "/joint_states", "sensor_msgs/msg/JointState", {"header": header, "position": [0.0]}, stamp
    )
    print(stamp, flush=True)
    time.sleep(0.002)
"""


@pytest.mark.parametrize("seconds", [0.9, 1.63])
def test_a_killed_recorder_loses_at_most_one_second(tmp_path: Path, seconds: float) -> None:
    path = tmp_path / "run.mcap"
    with subprocess.Popen([sys.executable, "-c", KILLED, str(path)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        written = [int(process.stdout.readline())]
        while written[-1] - written[0] < seconds * SECOND:
            written.append(int(process.stdout.readline()))
        os.kill(process.pid, signal.SIGKILL)
        written += [int(line) for line in process.stdout.read().split("\n") if line]
    found = [stamp for _, stamp, _ in messages_of(path)]
    assert found == written[: len(found)]
    assert written[-1] - found[-1] < SECOND
    with AnyReader([path]) as reader:
        assert reader.message_count == len(found)
    assert "was not finished" in str(read_recording(path).damaged)


FULL_DISK = """
import json, resource, signal, sys
from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
writer = RecordingWriter(sys.argv[1], flush_period=0.0)
count = 0
try:
    while True:
        writer.write_fields("/voltage_command", "std_msgs/msg/Float64", {"data": count * 0.1}, count * 10**6)
        count += 1
except RecordingError as error:
    print(json.dumps([count, str(error)]))
"""


def test_a_full_disk_is_reported_and_what_was_flushed_stays_readable(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    result = subprocess.run([sys.executable, "-c", FULL_DISK, str(path)], capture_output=True, text=True, timeout=60)
    assert result.stderr == ""
    count, message = json.loads(result.stdout)
    assert message == f"{path}: recording stopped (File too large)"
    assert count > 10
    assert len(messages_of(path)) == count
    assert "was not finished" in str(read_recording(path).damaged)


def test_a_silent_topic_is_put_on_disk_by_flush(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    writer = RecordingWriter(path, flush_period=0.05)
    writer.write_fields("/voltage_command", FLOAT, {"data": 1.0}, START)
    time.sleep(0.1)
    assert messages_of(path) == []
    writer.flush()
    assert len(messages_of(path)) == 1
    writer.close()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # it may fall into a finaliser
def test_an_interrupt_at_any_moment_leaves_whole_records(tmp_path: Path) -> None:
    """Ctrl-C raises KeyboardInterrupt in the middle of whatever the main thread does."""
    generator, volts = np.random.default_rng(7), encode(FLOAT, {"data": 0.1})
    main, pressed = threading.get_ident(), threading.Event()

    def press() -> None:
        signal.pthread_kill(main, signal.SIGINT)
        pressed.set()

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        for number in range(80):
            pressed.clear()
            writer = RecordingWriter(tmp_path / f"run_{number}.mcap", flush_period=2e-3)
            try:
                threading.Timer(generator.uniform(1e-3, 2e-2), press).start()
                while not pressed.is_set():  # in a finaliser Python drops it
                    writer.write("/volts", FLOAT, volts, time.time_ns())
            except KeyboardInterrupt:
                pass
            writer.close()
            with AnyReader([writer.path]) as bag:
                kept = sum(1 for _ in bag.messages())
            assert kept - writer.message_count in (0, 1)  # the last one may not have been counted any more
            assert pressed.wait(10.0)
    finally:
        signal.signal(signal.SIGINT, before)
