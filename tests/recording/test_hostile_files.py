"""Files made to harm: definitions that nest or grow without bound, databases that compute, what is no file at all."""

from __future__ import annotations

import os
import sqlite3
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from recordings import SECOND, START
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from eha_core.errors import RecordingError
from eha_core.recording import encode, read_recording

BREAK = "=" * 80


def nested(levels: int, width: int = 1, kind: str = "") -> str:
    """A type of so many levels, each of `width` parts of the next."""
    parts = ["\n".join(f"hostile/T0{kind} f{k}" for k in range(width)) + "\nfloat64 data"]
    for level in range(levels):
        inner = f"hostile/T{level + 1}{kind}" if level + 1 < levels else "float64"
        fields = "\n".join(f"{inner} f{k}" for k in range(width))
        parts.append(f"MSG: hostile/T{level}\n{fields}")
    return f"\n{BREAK}\n".join(parts)


def one_message(path: Path, definition: str, data: bytes, topic: str = "/voltage_command") -> Path:
    writer: Any = McapWriter(str(path))
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", definition.encode())
    channel = writer.register_channel(topic, "cdr", schema)
    for k in range(3):
        writer.add_message(channel, START + k * SECOND, data, START)
    writer.finish()
    return path


@pytest.mark.parametrize(
    "definition",
    [
        nested(3000),
        nested(40),
        nested(12, 12),
        nested(4, 1, "[100000]"),
        "std_msgs/Float64 data",
        f"hostile/A a\nfloat64 data\n{BREAK}\nMSG: hostile/A\nhostile/A a",
        "float64[4294967295] many\nfloat64 data",
        "float64 data\n" * 40_000,
        "\n".join(f"float64 f{k}" for k in range(20_000)),
    ],
    ids=["3000 deep", "40 deep", "12 to the 12", "arrays", "itself", "a ring", "one array", "twice", "fields"],
)
def test_a_hostile_definition_gives_way_to_the_installed_one_and_is_told(tmp_path: Path, definition: str) -> None:
    path = one_message(tmp_path / "run.mcap", definition, encode("std_msgs/msg/Float64", {"data": 0.5}))
    started = time.monotonic()
    recording = read_recording(path)
    assert time.monotonic() - started < 5.0
    assert recording.channels["voltage_command"].values.tolist() == [0.5, 0.5, 0.5]
    (remark,) = recording.remarks
    assert remark.startswith("/voltage_command: the definition of std_msgs/msg/Float64 in the file cannot be used;")


def test_a_definition_of_another_shape_is_read_by_itself(tmp_path: Path) -> None:
    """What the file says of itself counts, not what is installed under the same name."""
    data = b"\0\1\0\0" + np.array([7.0, 0.25]).tobytes()
    path = one_message(tmp_path / "run.mcap", "float64 before\nfloat64 data", data)
    recording = read_recording(path)
    assert recording.channels["voltage_command"].values.tolist() == [0.25] * 3 and recording.remarks == ()


def test_names_that_a_file_brings_cannot_write_to_the_terminal(tmp_path: Path) -> None:
    topic = "/\x1b]0;owned\x07\x1b[2J\u202e"
    path = one_message(tmp_path / "run.mcap", "float64 data", b"", topic)
    with pytest.raises(RecordingError) as caught:
        read_recording(path)
    assert str(caught.value).isprintable() and "owned" in str(caught.value)


@pytest.fixture
def database(tmp_path: Path) -> Path:
    """A sound .db3 of 60 messages."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(tmp_path / "bag", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/voltage_command", "std_msgs/msg/Float64", typestore=store)
        for k in range(60):
            writer.write(connection, START + k * SECOND, encode("std_msgs/msg/Float64", {"data": k * 0.1}))
    return next((tmp_path / "bag").glob("*.db3"))


@pytest.mark.parametrize(
    "statements",
    [
        ["CREATE VIEW endless AS WITH RECURSIVE r(x) AS (SELECT 1 UNION ALL SELECT x FROM r) SELECT x FROM r"],
        [
            "ALTER TABLE messages RENAME TO old",
            "CREATE TABLE messages (id INTEGER, topic_id INTEGER, timestamp INTEGER,"
            " data BLOB GENERATED ALWAYS AS (zeroblob(900000000)) VIRTUAL)",
            "INSERT INTO messages (id, topic_id, timestamp) SELECT id, topic_id, timestamp FROM old",
        ],
    ],
)
def test_a_database_that_computes_is_refused(database: Path, statements: list[str]) -> None:
    connection = sqlite3.connect(database)
    for statement in statements:
        connection.execute(statement)
    connection.commit()
    connection.close()
    with pytest.raises(RecordingError, match=r"\.db3: its (view|table) \w+ computes values"):
        read_recording(database)


@pytest.mark.parametrize("seed", range(30))
def test_a_damaged_database_gives_what_it_can_or_one_line(database: Path, seed: int) -> None:
    content = bytearray(database.read_bytes())
    generator = np.random.default_rng(seed)
    for place in generator.integers(0, len(content), 1 + 3 * seed):
        content[place] = generator.integers(256)
    database.write_bytes(content[: len(content) // 2] if seed % 5 == 4 else content)
    try:
        assert len(read_recording(database).channels["voltage_command"].values) <= 60
    except RecordingError as error:
        assert str(error).isprintable()


def test_what_is_no_file_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(RecordingError, match="is neither a file nor a folder"):
        read_recording(tmp_path / "pipe.csv")
    with pytest.raises(RecordingError, match="is neither a file nor a folder"):
        read_recording("/dev/zero")
