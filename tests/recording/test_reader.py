"""Channels out of recordings: names, units, pressure references, namespaces, clocks, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recordings import ATMOSPHERE, SECOND, START, header, piston_recording, write_piston

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter, read_recording
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.topics_file import TopicsFile

FLOAT = "std_msgs/msg/Float64"
PRESSURE = "sensor_msgs/msg/FluidPressure"
JOINTS = "sensor_msgs/msg/JointState"


def topics_file(folder: Path, text: str) -> Path:
    path = folder / "topics.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("namespace", ["", "/rig", "/lab/rig_2"])
def test_channels_are_found_under_any_namespace(tmp_path: Path, namespace: str) -> None:
    recording = read_recording(piston_recording(tmp_path / "run.mcap", namespace=namespace))
    assert list(recording.channels) == ["voltage_command", "pressure_a", "pressure_b", "position", "velocity"]
    k = np.arange(100)
    for name, values in {
        "voltage_command": k * 1e-3,
        "position": k * 1e-6,
        "velocity": k * 1e-3,
        "pressure_a": 1e6 + k,
        "pressure_b": 2e6 + k,
    }.items():
        np.testing.assert_allclose(recording.channels[name].values, values, rtol=0, atol=1e-9)
        np.testing.assert_allclose(recording.channels[name].time, k * 0.01, rtol=0, atol=1e-9)
    assert recording.channels["pressure_a"].topic == f"{namespace}/chamber_a/pressure"
    assert recording.channels["pressure_a"].type == PRESSURE
    assert [channel.unit for channel in recording.channels.values()] == ["V", "Pa", "Pa", "m", "m/s"]
    assert (recording.start_stamp, recording.damaged, recording.remarks) == (START, None, ())
    assert recording.duration == pytest.approx(0.99)


def test_the_stored_atmosphere_is_subtracted(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "run.mcap", {"atmospheric_pressure": 80000.0}) as writer:
        write_piston(writer, count=2)
    pressure = read_recording(tmp_path / "run.mcap").channels["pressure_a"].values
    np.testing.assert_allclose(pressure, 1e6 + np.arange(2) + ATMOSPHERE - 80000.0)


@pytest.mark.parametrize(
    ("topics", "channels"),
    [
        (("voltage_command",), {"voltage_command"}),
        (("joint_states",), {"position", "velocity", "force"}),
        (("voltage_command", "joint_states"), {"voltage_command", "position", "velocity", "force"}),
        (("chamber_a/pressure", "joint_states"), {"pressure_a", "position", "velocity", "force"}),
        (("chamber_a/pressure", "chamber_b/pressure"), {"pressure_a", "pressure_b"}),
    ],
)
def test_every_subset_is_legal(tmp_path: Path, topics: tuple[str, ...], channels: set[str]) -> None:
    assert read_recording(piston_recording(tmp_path / "run.mcap", topics=topics)).channels.keys() == channels


def test_a_topics_file_maps_fields_units_and_references(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "run.mcap") as writer:
        for k in range(5):
            stamp = START + k * SECOND
            wrench = {"header": header(stamp), "wrench": {"force": {"x": 10.0 * k}}}
            writer.write_fields("/loadcell", "geometry_msgs/msg/WrenchStamped", wrench, stamp)
            writer.write_fields("/valve/cmd", FLOAT, {"data": 2.0 * k}, stamp)
            writer.write_fields("/cyl/p_head", PRESSURE, {"header": header(stamp), "fluid_pressure": 10.0 * k}, stamp)
            joints = {"header": header(stamp), "name": ["left", "right"], "position": [1.0, 100.0 + k]}
            writer.write_fields("/cyl/joint_states", JOINTS, joints, stamp)
    mapping = topics_file(
        tmp_path,
        """
channels:
  voltage_command: {topic: /valve/cmd, field: data, scale: 0.5, offset: -1.0}
  position: {topic: /cyl/joint_states, field: "position[1]", scale: 1.0e-3}
  pressure_a: {topic: /cyl/p_head, field: fluid_pressure, scale: 1.0e5, reference: gauge}
  force: {topic: /loadcell, field: wrench.force.x}
  velocity: null
""",
    )
    channels = read_recording(tmp_path / "run.mcap", mapping).channels
    k = np.arange(5)
    assert channels.keys() == {"voltage_command", "position", "pressure_a", "force"}
    np.testing.assert_allclose(channels["voltage_command"].values, k - 1.0)
    np.testing.assert_allclose(channels["position"].values, 0.1 + k * 1e-3)
    np.testing.assert_allclose(channels["pressure_a"].values, 1e6 * k)
    np.testing.assert_allclose(channels["force"].values, 10.0 * k)


def test_a_mapped_pressure_is_absolute_unless_said_otherwise(tmp_path: Path) -> None:
    path = piston_recording(tmp_path / "run.mcap", count=3)
    absolute = read_recording(
        path, topics_file(tmp_path, "channels: {pressure_a: {topic: /chamber_a/pressure, field: fluid_pressure}}")
    )
    gauge = read_recording(path, topics_file(tmp_path, "channels: {pressure_a: {reference: gauge}}"))
    np.testing.assert_allclose(absolute.channels["pressure_a"].values, 1e6 + np.arange(3))
    np.testing.assert_allclose(gauge.channels["pressure_a"].values, 1e6 + np.arange(3) + ATMOSPHERE)
    assert gauge.channels.keys() == {"voltage_command", "position", "velocity", "pressure_a", "pressure_b"}
    assert any("pressure_a" in one and "taken as absolute" in one for one in absolute.remarks)
    assert not any("taken as absolute" in one for one in (*gauge.remarks, *read_recording(path).remarks))


def test_two_pistons_are_refused_by_name_and_a_namespace_chooses(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        write_piston(writer, count=5, namespace="/left")
        write_piston(writer, count=7, namespace="/right")
    with pytest.raises(RecordingError, match="the pistons of namespaces /left and /right; choose one .* topics file"):
        read_recording(path)
    chosen = read_recording(path, topics_file(tmp_path, "namespace: /right\nchannels: {}"))
    assert {channel.topic.split("/")[1] for channel in chosen.channels.values()} == {"right"}
    assert len(chosen.channels["voltage_command"].time) == 7


def test_two_joints_in_one_message_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/joint_states", JOINTS, {"name": ["boom", "stick"], "position": [1.0, 2.0]}, START)
    with pytest.raises(RecordingError, match="holds the joints boom, stick and none is called piston"):
        read_recording(path)


def test_the_joint_called_piston_is_taken_among_others(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/joint_states", JOINTS, {"name": ["boom", "piston"], "position": [1.0, 2.0]}, START)
    assert read_recording(path).channels["position"].values.tolist() == [2.0]


def test_leakage_changes_and_parameters_are_kept(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, {"internal_leakage": 1e-12, "moving_mass": 9.0}) as writer:
        writer.write_fields("/eha/internal_leakage", FLOAT, {"data": 1e-12}, START - SECOND)
        write_piston(writer, namespace="/eha")
        writer.write_fields("/eha/internal_leakage", FLOAT, {"data": 1e-10}, START + SECOND // 2)
    recording = read_recording(path)
    assert recording.leakage_changes == ((-1.0, 1e-12), (0.5, 1e-10))
    assert recording.parameters == {"internal_leakage": 1e-12, "moving_mass": 9.0}
    assert recording.start_stamp == START


def test_stamps_count_where_messages_have_them(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(4):
            joints = {"header": header(START + k * SECOND), "name": ["piston"], "position": [0.1]}
            writer.write_fields("/joint_states", JOINTS, joints, START + k * SECOND + 3_000_000)
            writer.write_fields("/voltage_command", FLOAT, {"data": 0.0}, START + k * SECOND + 5_000_000)
    channels = read_recording(path).channels
    np.testing.assert_allclose(channels["position"].time, [0, 1, 2, 3])
    np.testing.assert_allclose(channels["voltage_command"].time, [0.005, 1.005, 2.005, 3.005])


def test_headers_that_nobody_filled_in_give_way_to_log_times(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(3):
            writer.write_fields("/joint_states", JOINTS, {"position": [0.1]}, START + k * SECOND)
    recording = read_recording(path)
    np.testing.assert_allclose(recording.channels["position"].time, [0, 1, 2])
    assert recording.start_stamp == START


def test_simulation_stamps_and_wall_clock_logs_meet_on_one_clock(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(4):
            joints = {"header": header(k * SECOND), "position": [0.1]}
            writer.write_fields("/joint_states", JOINTS, joints, START + k * SECOND)
            writer.write_fields("/voltage_command", FLOAT, {"data": 0.0}, START + k * SECOND + 1000)
    recording = read_recording(path)
    np.testing.assert_allclose(recording.channels["position"].time, [0, 1, 2, 3])
    np.testing.assert_allclose(recording.channels["voltage_command"].time, np.arange(4) + 1e-6)
    assert any("clocks of /voltage_command, /joint_states" in remark for remark in recording.remarks)


def test_disorder_is_left_out_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    positions = [0.0, 1.0, float("nan"), 3.0, 3.0, 2.0, 4.0, 5.0]
    stamps = [0, 1, 2, 3, 3, 1, 4, 5]
    with RecordingWriter(path) as writer:
        for position, stamp in zip(positions, stamps, strict=True):
            joints = {"header": header(START + stamp * SECOND), "position": [position]}
            writer.write_fields("/joint_states", JOINTS, joints, START)
    recording = read_recording(path)
    assert recording.channels["position"].values.tolist() == [0.0, 1.0, 3.0, 4.0, 5.0]
    assert recording.remarks == (
        "position (/joint_states): 1 samples that are not finite numbers were left out",
        "position (/joint_states): 1 samples with the stamp of the one before were left out",
        "position (/joint_states): 1 samples were left out because time runs backwards there",
    )


def test_a_joint_without_speed_and_force_is_complete_unless_they_were_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(4):
            writer.write_fields(
                "/joint_states", JOINTS, {"header": header(START + k * SECOND), "position": [0.1]}, START
            )
    assert read_recording(path).remarks == ()
    asked = TopicsFile({"velocity": ChannelRule("/joint_states", "velocity[0]")})
    assert "velocity (/joint_states): no values were recorded" in read_recording(path, asked).remarks


def test_the_simulators_truth_is_not_read_as_a_measurement(tmp_path: Path) -> None:
    state = {"voltage": 0.5, "position": 1.0, "measured_position": 0.1, "measured_pressure_a": 5e6}
    path = tmp_path / "both.mcap"
    with RecordingWriter(path) as writer:
        write_piston(writer, count=2, topics=("joint_states",))
        writer.write_fields("/state", "eha_interfaces/msg/ActuatorState", {"header": header(START), **state}, START)
    assert "pressure_a" not in read_recording(path).channels
    alone = tmp_path / "alone.mcap"
    with RecordingWriter(alone) as writer:
        writer.write_fields("/state", "eha_interfaces/msg/ActuatorState", {"header": header(START), **state}, START)
    channels = read_recording(alone).channels
    assert {name: channel.values[0] for name, channel in channels.items() if channel.values[0]} == {
        "voltage_command": 0.5,
        "position": 0.1,
        "pressure_a": 5e6,
    }


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        ("channels: {pressure_a: {topic: /p}}", "no topic /p for channel pressure_a; recorded are /chamber_a/pressure"),
        ("channels: {presure_a: {topic: /p}}", "unknown channel 'presure_a'; known are voltage_command, current"),
        ("channels: {position: {topic: /joint_states, units: mm}}", "unknown key of position 'units'"),
        ("channels: {position: {scale: big}}", "channel position: scale 'big' is not a number"),
        ("channels: {pressure_a: {reference: sealed}}", "reference 'sealed'; say absolute or gauge"),
        ("channels: {position: {field: places}}", "no field 'places'; its fields are header, name, position"),
        ("channels: {position: {field: name}}", "field 'name' is not one number"),
        ("channels: {position: {field: 'position['}}", r"field 'position\[' is not a path"),
        ("channels: {current: {scale: 2.0}}", "names no topic for channel current; add `topic:`"),
        ("channels: [position]", "needs `channels:`"),
        ("channels: {position", r"this is not YAML \(line 1: "),
        ("channels: {position: /joint_states}", "channel position: needs keys such as"),
    ],
)
def test_a_wrong_topics_file_is_refused_in_one_line(tmp_path: Path, mapping: str, message: str) -> None:
    path = piston_recording(tmp_path / "run.mcap", count=3)
    with pytest.raises(RecordingError, match=message) as caught:
        read_recording(path, topics_file(tmp_path, mapping))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("scale", [1e-5, 1e5])
def test_a_pressure_in_another_unit_is_refused(tmp_path: Path, scale: float) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(3):
            writer.write_fields("/chamber_a/pressure", PRESSURE, {"fluid_pressure": (5e6 + k) * scale}, START + k)
    with pytest.raises(RecordingError, match="pressure_a .* give its `scale` to Pa in a topics file"):
        read_recording(path)


def test_a_gauge_pressure_passed_off_as_absolute_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/chamber_a/pressure", PRESSURE, {"fluid_pressure": -3e4}, START)
    with pytest.raises(RecordingError, match="mostly negative.*`reference: gauge`"):
        read_recording(path)


def test_a_command_of_another_type_is_refused_by_its_fields(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/voltage_command", "geometry_msgs/msg/Twist", {}, START)
    with pytest.raises(
        RecordingError, match="/voltage_command: its message has no field 'data'; its fields are linear"
    ):
        read_recording(path)


def test_a_recording_without_channels_names_what_it_holds(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        writer.write_fields("/camera/gain", FLOAT, {"data": 1.0}, START)
    with pytest.raises(
        RecordingError, match=r"no usable channel; recorded topics: /camera/gain \(std_msgs/msg/Float64\)"
    ):
        read_recording(path)


def test_outliers_that_no_rig_shows_are_left_out_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path) as writer:
        for k in range(300):
            place = 1e6 if k == 100 else k * 1e-4
            joints = {"header": header(START + k * SECOND // 100), "position": [place]}
            writer.write_fields("/joint_states", JOINTS, joints, START)
    recording = read_recording(path)
    assert len(recording.channels["position"].values) == 299
    assert "position (/joint_states): 1 samples beyond 50 m were left out" in recording.remarks


@pytest.mark.parametrize("leap", [-40, -2 * 3600, 26 * 3600])
def test_a_clock_that_leaps_leaves_all_channels_on_one_side(tmp_path: Path, leap: int) -> None:
    """The topics' stamps leap at slightly different messages, in the middle: each has as many on either side."""
    path = tmp_path / "run.mcap"
    topics = ("joint_states", "chamber_a/pressure", "chamber_b/pressure")
    with RecordingWriter(path, flush_period=1e9) as writer:
        for k in range(2000):
            logged = START + k * SECOND // 100
            for number, topic in enumerate(topics):
                stamp = logged + (leap * SECOND if k >= 1000 + number - 1 else 0)
                values = (
                    {"name": ["piston"], "position": [k * 1e-6], "velocity": [0.0], "effort": [0.0]}
                    if number == 0
                    else {"fluid_pressure": 1e6 + k}
                )
                kind = "sensor_msgs/msg/JointState" if number == 0 else "sensor_msgs/msg/FluidPressure"
                writer.write_fields(f"/{topic}", kind, {"header": header(stamp), **values}, logged)
    recording = read_recording(path)
    assert recording.duration < 10.1
    assert any("the clock of the stamps leapt" in remark for remark in recording.remarks)
    position, pressure = recording.channels["position"], recording.channels["pressure_a"]
    assert len(position.time) > 990
    at_position = np.interp(position.time, pressure.time, pressure.values + 101325.0 - 1e6)
    np.testing.assert_allclose(at_position, position.values * 1e6, atol=1.1)


def test_a_stored_parameter_that_is_no_number_is_left_out_and_said(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with RecordingWriter(path, {"moving_mass": "heavy", "piston_area": 1e-3, "plant.load": "sprung_mass"}) as writer:
        write_piston(writer, count=2)
    recording = read_recording(path)
    assert (recording.parameters, recording.parts) == ({"piston_area": 1e-3}, {"load": "sprung_mass"})
    assert recording.remarks == ("the stored parameter moving_mass is not a number ('heavy') and was left out",)
