"""ros2_control's introspection: values in one message with their names, or names and values on topics of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import read_recording
from eha_core.recording.cdr_layout import Layout
from eha_core.recording.inspection import _by_names, inspect_file

PACKAGE = "pal_statistics_msgs/msg"
DEFINITIONS = {
    f"{PACKAGE}/Statistic": "string name\nfloat64 value\n",
    f"{PACKAGE}/Statistics": f"std_msgs/Header header\n{PACKAGE}/Statistic[] statistics\n",
    f"{PACKAGE}/StatisticsNames": "std_msgs/Header header\nstring[] names\nuint32 names_version\n",
    f"{PACKAGE}/StatisticsValues": "std_msgs/Header header\nfloat64[] values\nuint32 names_version\n",
}
PREFIX = "/controller_manager/introspection_data"
POSITION, EFFORT = "state_interface.piston/position", "command_interface.piston/effort"
START = 1_700_000_000_000_000_000
COUNT = 40


def introspection_bag(folder: Path, with_names: bool = True) -> Path:
    """Sample k: position k um, effort k mV. After half of them an interface more comes first in the list."""
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    path = folder / "introspection"
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topics = {
            kind: writer.add_connection(f"{PREFIX}/{kind}", f"{PACKAGE}/{name}", typestore=store)
            for kind, name in (("full", "Statistics"), ("names", "StatisticsNames"), ("values", "StatisticsValues"))
        }

        def write(kind: str, stamp: int, **fields: object) -> None:
            time = store.types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
            header = store.types["std_msgs/msg/Header"](stamp=time, frame_id="")
            name = topics[kind].msgtype
            writer.write(topics[kind], stamp, store.serialize_cdr(store.types[name](header=header, **fields), name))

        for k in range(COUNT):
            late = k >= COUNT // 2
            names = [*(["state_interface.arm/position"] if late else []), POSITION, EFFORT]
            values = [*([-1.0] if late else []), k * 1e-6, k * 1e-3]
            stamp = START + k * 10_000_000
            if with_names and k in (0, COUNT // 2):
                write("names", stamp, names=names, names_version=1 + late)
            write("values", stamp, values=np.array(values), names_version=1 + late)
            statistic = store.types[f"{PACKAGE}/Statistic"]
            parts = [statistic(name=name, value=value) for name, value in zip(names, values, strict=True)]
            write("full", stamp, statistics=parts)
    return path


def topics_file(folder: Path, topic: str, field: str) -> Path:
    path = folder / "topics.yaml"
    path.write_text(
        "channels:\n"
        f"  position: {{topic: {PREFIX}/{topic}, field: '{field % POSITION}'}}\n"
        f"  voltage_command: {{topic: {PREFIX}/{topic}, field: '{field % EFFORT}'}}\n"
    )
    return path


@pytest.mark.parametrize(("topic", "field"), [("values", "values[%s]"), ("full", "statistics[%s].value")])
def test_values_are_found_by_name_though_the_list_changes(tmp_path: Path, topic: str, field: str) -> None:
    recording = read_recording(introspection_bag(tmp_path), topics_file(tmp_path, topic, field))
    np.testing.assert_allclose(recording.channels["position"].values, np.arange(COUNT) * 1e-6)
    np.testing.assert_allclose(recording.channels["voltage_command"].values, np.arange(COUNT) * 1e-3)
    np.testing.assert_allclose(recording.channels["position"].time, np.arange(COUNT) / 100)


def test_an_inspection_lists_values_by_name_where_they_have_one(tmp_path: Path) -> None:
    listed = {(one.topic, one.path) for one in inspect_file(introspection_bag(tmp_path)).fields}
    assert (f"{PREFIX}/full", f"statistics[{POSITION}].value") in listed
    assert (f"{PREFIX}/values", f"values[{POSITION}]") in listed
    assert not any("statistics[0]" in path or "values[0]" in path for _, path in listed)


@pytest.mark.parametrize("name", ["", "7", "arm[2]", "two\nlines"])
def test_a_name_that_cannot_stand_in_a_path_is_left_a_number(name: str) -> None:
    layout = Layout(0, texts={"statistics[3].name": name, "statistics[4].name": "arm"})
    assert _by_names("statistics[3].value", layout) == "statistics[3].value"
    assert _by_names("statistics[4].value", layout) == "statistics[arm].value"


def test_values_without_their_names_are_refused_with_what_to_record(tmp_path: Path) -> None:
    path = introspection_bag(tmp_path, with_names=False)
    with pytest.raises(RecordingError, match=f"version 1. were not recorded; record {PREFIX}/names from its start"):
        read_recording(path, topics_file(tmp_path, "values", "values[%s]"))


def test_a_name_that_is_not_there_is_answered_with_those_that_are(tmp_path: Path) -> None:
    path = introspection_bag(tmp_path)
    with pytest.raises(RecordingError, match=f"holds the names {POSITION}, {EFFORT} and none is called"):
        read_recording(path, topics_file(tmp_path, "full", "statistics[%sx].value"))


def test_names_whose_message_is_another_than_its_type_says_are_passed_over(tmp_path: Path) -> None:
    """A node of another version: `names` is a count there, and no list."""
    numbered = {f"{PACKAGE}/StatisticsNames": "std_msgs/Header header\nuint32 names\nuint32 names_version\n"}
    store = get_typestore(Stores.ROS2_JAZZY)
    for name, definition in (DEFINITIONS | numbered).items():
        store.register(get_types_from_msg(definition, name))
    time = store.types["builtin_interfaces/msg/Time"](sec=1_700_000_000, nanosec=0)
    header = store.types["std_msgs/msg/Header"](stamp=time, frame_id="")
    path = tmp_path / "introspection"
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        fields = {"names": {"names": 2}, "values": {"values": np.array([1.0, 2.0])}}
        for kind, name in (("names", f"{PACKAGE}/StatisticsNames"), ("values", f"{PACKAGE}/StatisticsValues")):
            connection = writer.add_connection(f"{PREFIX}/{kind}", name, typestore=store)
            message = store.types[name](header=header, names_version=1, **fields[kind])
            writer.write(connection, START, store.serialize_cdr(message, name))
    with pytest.raises(RecordingError, match="version 1. were not recorded"):
        read_recording(path, topics_file(tmp_path, "values", "values[%s]"))
