"""Topics as columns: whatever the messages' structure does, each number is the one that rosbags reads."""

from __future__ import annotations

import tracemalloc
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from recordings import SECOND, START, header, piston_recording
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import RecordingWriter, definition_of, encode, read_recording
from eha_core.recording.raw import RawTopic
from eha_core.recording.topic_columns import BLOCK, MOST_LAYOUTS, DecodedTopic, TopicColumns

JOINTS = "sensor_msgs/msg/JointState"


def columns_of(payloads: Sequence[bytes], fields: dict[str, str], type_name: str = JOINTS) -> DecodedTopic:
    """The payloads, recorded 1 ms apart, half of them one by one and half as one block."""
    sink = TopicColumns(RawTopic("/topic", type_name, "ros2msg", definition_of(type_name)[0]), fields)
    half = len(payloads) // 2
    for index, payload in enumerate(payloads[:half]):
        sink.add(index * 1_000_000, payload)
    lengths = np.array([len(payload) for payload in payloads[half:]], dtype=np.int64)
    log_times = np.arange(half, len(payloads), dtype=np.int64) * 1_000_000
    sink.add_block(b"".join(payloads[half:]), np.cumsum(lengths) - lengths, lengths, log_times)
    return sink.finish()


def joints(names: list[str], position: list[float], frame: str = "", stamp: int = 0) -> bytes:
    fields = {"header": {**header(stamp), "frame_id": frame}, "name": names, "position": position}
    return encode(JOINTS, fields)


def test_messages_of_changing_structure_give_what_rosbags_reads() -> None:
    generator = np.random.default_rng(3)
    payloads = []
    for k in range(3 * BLOCK):
        count = int(generator.integers(1, 4))
        frame = "f" * int(generator.integers(5))
        payloads.append(joints(["a"] * count, list(generator.normal(size=count)), frame, START + k))
    decoded = columns_of(payloads, {"first": "position[0]", "third": "position[2]"})
    store = get_typestore(Stores.ROS2_JAZZY)
    messages = [store.deserialize_cdr(payload, JOINTS) for payload in payloads]
    third = [message.position[2] if len(message.position) > 2 else np.nan for message in messages]  # type: ignore[attr-defined]
    np.testing.assert_array_equal(decoded.columns["first"], [message.position[0] for message in messages])  # type: ignore[attr-defined]
    np.testing.assert_array_equal(decoded.columns["third"], third)
    np.testing.assert_array_equal(decoded.stamps, START + np.arange(len(payloads)))
    assert decoded.remarks == ()


def test_more_layouts_than_are_kept_are_read_all_the_same() -> None:
    frames = ["f" * (k % (3 * MOST_LAYOUTS)) for k in range(500)]
    decoded = columns_of([joints(["a"], [float(k)], frame) for k, frame in enumerate(frames)], {"x": "position[0]"})
    np.testing.assert_array_equal(decoded.columns["x"], np.arange(500.0))


def test_joints_that_change_places_are_followed_by_name() -> None:
    payloads = [joints(["piston", "boom"], [1.0, 2.0]), joints(["boom", "piston"], [4.0, 3.0])] * 10
    np.testing.assert_array_equal(columns_of(payloads, {"x": "position[piston]"}).columns["x"], [1.0, 3.0] * 10)


@pytest.mark.parametrize(("count", "end"), [(20, "j19 and none"), (21, r"j19 \.\.\. and none")])
def test_of_many_joints_the_first_twenty_are_listed(count: int, end: str) -> None:
    names = [f"j{k}" for k in range(count)]
    with pytest.raises(RecordingError, match=rf"holds the joints j0, j1, .*{end} is called piston"):
        columns_of([joints(names, [0.0] * count)] * 2, {"x": "position[piston]"})


def test_a_joint_that_some_messages_lack_is_missing_there() -> None:
    payloads = [joints(["piston", "boom"], [1.0, 2.0]), joints(["boom", "arm"], [4.0, 3.0])]
    np.testing.assert_array_equal(columns_of(payloads, {"x": "position[piston]"}).columns["x"], [1.0, np.nan])


@pytest.mark.parametrize(
    ("field", "message"),
    [
        ("position[piston]", "holds the joints boom, arm and none is called piston"),
        ("positio[0]", "has no field 'positio\\[0\\]'; its fields are header, name, position"),
        ("position", "is not one number; name an element such as position\\[0\\]"),
        ("header", "is not one number"),
        ("name[0]", "is not one number"),
        ("header.stamp.sec[0]", "has an index where there is one value"),
        ("position[0", "is not a path such as"),
        ("position[0].x", "has no field"),
    ],
)
def test_a_field_that_is_no_number_is_refused(field: str, message: str) -> None:
    with pytest.raises(RecordingError, match=message):
        columns_of([joints(["boom", "arm"], [4.0, 3.0])], {"x": field})


def test_bytes_that_are_no_message_are_counted_and_cost_no_other() -> None:
    payloads = [joints(["a"], [float(k)]) for k in range(100)]
    payloads[3], payloads[70] = payloads[3][:40], b""
    decoded = columns_of(payloads, {"x": "position[0]"})
    assert decoded.remarks == ("/topic: 2 messages that do not decode were left out",)
    np.testing.assert_array_equal(decoded.columns["x"], np.delete(np.arange(100.0), [3, 70]))
    assert len(decoded.logged) == 98


def test_reading_keeps_the_wanted_numbers_and_not_the_messages(tmp_path: Path) -> None:
    path = tmp_path / "long.mcap"
    count, frame = 20_000, "x" * 2000
    with RecordingWriter(path) as writer:
        for k in range(count):
            stamp = START + k * SECOND // 1000
            fields = {
                "header": {**header(stamp), "frame_id": frame},
                "name": ["piston"],
                "position": [1e-6 * (k % 997)],
            }
            writer.write_fields("joint_states", JOINTS, fields, stamp)
    read_recording(piston_recording(tmp_path / "short.mcap"))  # what is loaded once is no cost of the length
    tracemalloc.start()
    recording = read_recording(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(recording.channels["position"].values) == count
    # 42 MB of messages; a chunk of them and a few columns of 0.16 MB at a time.
    assert peak < 12e6


def test_log_times_of_any_sign_are_taken() -> None:
    sink = TopicColumns(RawTopic("/topic", JOINTS, "ros2msg", definition_of(JOINTS)[0]), {"x": "position[0]"})
    for log_time in (-8_330_100_865_958_439_936, 2**64 - 1, 5):
        sink.add(log_time, joints(["a"], [1.0]))
    assert sink.finish().logged.tolist() == [-8_330_100_865_958_439_936, -1, 5]


def test_each_block_of_a_topic_is_given_once() -> None:
    sink = TopicColumns(RawTopic("/topic", JOINTS, "ros2msg", definition_of(JOINTS)[0]), {"x": "position[0]"})
    sink.add(7, joints(["a"], [1.0], "", 5))
    first, second = sink.finish(), sink.finish()
    assert (first.columns["x"].tolist(), first.stamps.tolist(), first.lead) == ([1.0], [5], 2)
    assert (second.columns["x"].tolist(), second.stamps.tolist(), second.logged.tolist()) == ([], [], [])


def test_stamps_that_nobody_filled_in_are_the_log_times() -> None:
    decoded = columns_of([joints(["a"], [float(k)]) for k in range(6)], {"x": "position[0]"})
    assert decoded.stamps.tolist() == decoded.logged.tolist() == [k * 1_000_000 for k in range(6)]
    assert decoded.lead == 0
    one = columns_of([joints(["a"], [float(k)], "", 5 if k == 3 else 0) for k in range(6)], {"x": "position[0]"})
    assert one.stamps.tolist() == [0, 0, 0, 5, 0, 0]


def test_messages_of_one_layout_are_told_apart_by_their_names_alone() -> None:
    """Also those of parts, whose names are of one length."""
    cloud = "sensor_msgs/msg/PointCloud2"
    payloads = [
        encode(cloud, {"fields": [{"name": name, "offset": k} for k, name in enumerate(names, start=1)]})
        for names in ("yz", "xy", "yx", "xz", "yx")
    ]
    assert len({len(payload) for payload in payloads}) == 1
    decoded = columns_of(payloads, {"y": "fields[y].offset"}, cloud)
    np.testing.assert_array_equal(decoded.columns["y"], [1.0, 2.0, 1.0, np.nan, 1.0])


def test_messages_of_either_order_of_bytes_are_told_apart() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = "std_msgs/msg/Float64"
    payloads = [
        bytes(store.serialize_cdr(store.types[kind](data=float(k)), kind, little_endian=k % 2 == 0))  # type: ignore[call-arg]
        for k in range(6)
    ]
    np.testing.assert_array_equal(columns_of(payloads, {"u": "data"}, kind).columns["u"], np.arange(6.0))
