"""Recordings as files: MCAP with the profile `ros2`, as `ros2 bag` writes it, and read back into channels.

Stamps are those of the samples, pressures in the file are absolute, and the metadata record `eha_parameters` has the
nominal parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from eha_exam.errors import ExamError

Array = NDArray[np.float64]
Arrays = dict[str, tuple[Array, Array]]
"""Channel name -> (time [s], value in SI; pressures gauge)."""

START = 1_700_000_000_000_000_000
"""ns; stamp of the first sample of every recording."""
PARAMETERS_RECORD = "eha_parameters"
STANDARD_ATMOSPHERE = 101325.0
"""Pa; of a recording whose parameters do not have it."""

FLOAT = "std_msgs/msg/Float64"
JOINTS = "sensor_msgs/msg/JointState"
PRESSURE = "sensor_msgs/msg/FluidPressure"

TOPICS = {
    "voltage_command": ("voltage_command", FLOAT),
    "position": ("joint_states", JOINTS),
    "pressure_a": ("chamber_a/pressure", PRESSURE),
    "pressure_b": ("chamber_b/pressure", PRESSURE),
}
"""Topic and message type of each channel."""

QUALITY = """\
- history: keep_last
  depth: 10
  reliability: reliable
  durability: volatile
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: automatic
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false"""
"""The quality of service with which `ros2 bag play` publishes a topic."""


@dataclass(frozen=True)
class Recording:
    """What a file holds: its channels, times from the first stamp of any, and the nominal parameters (SI)."""

    channels: Arrays
    parameters: Mapping[str, float]


@cache
def _types() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)


def write_recording(path: Path, arrays: Arrays, parameters: Mapping[str, float], compressed: bool = True) -> None:
    """Write the channels `arrays` with the nominal `parameters`, which hold `atmospheric_pressure` [Pa].

    One that is not `compressed` takes less space once the whole file is, for then its indexes are too.
    The folder is made where it is missing. ExamError where the file exists or cannot be written.
    """
    messages = sorted(_messages(arrays, parameters["atmospheric_pressure"]), key=lambda message: message[0])
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("xb") as stream:
            compression = CompressionType.ZSTD if compressed else CompressionType.NONE
            _write(Writer(stream, compression=compression), messages, parameters)
    except OSError as error:
        raise ExamError(f"{path}: cannot be written ({error.strerror}); give another folder") from error


def _write(writer: Any, messages: list[tuple[int, str, bytes]], parameters: Mapping[str, float]) -> None:
    writer.start(profile="ros2")
    writer.add_metadata(PARAMETERS_RECORD, {name: str(value) for name, value in parameters.items()})
    schemas: dict[str, int] = {}
    channels: dict[str, int] = {}
    for stamp, name, data in messages:
        if name not in channels:
            topic, kind = TOPICS[name]
            if kind not in schemas:
                definition = _types().generate_msgdef(kind, ros_version=2)[0]
                schemas[kind] = writer.register_schema(kind, "ros2msg", definition.encode())
            about = {"offered_qos_profiles": QUALITY, "topic_type_hash": _types().hash_rihs01(kind)}
            channels[name] = writer.register_channel(topic, "cdr", schemas[kind], about)
        writer.add_message(channels[name], log_time=stamp, data=data, publish_time=stamp)
    writer.finish()


def _messages(arrays: Arrays, atmosphere: float) -> Iterator[tuple[int, str, bytes]]:
    """(stamp [ns], channel, serialised message) of every sample."""
    types, empty = _types().types, np.zeros(0)
    for name, (time, values) in arrays.items():
        kind = TOPICS[name][1]
        make = types[kind]
        stamps = (START + np.round(time * 1e9).astype(np.int64)).tolist()
        for stamp, value in zip(stamps, values.tolist(), strict=True):
            at = types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
            header = types["std_msgs/msg/Header"](stamp=at, frame_id="")
            if kind == FLOAT:
                message = make(data=value)
            elif kind == JOINTS:
                message = make(header=header, name=["piston"], position=np.array([value]), velocity=empty, effort=empty)
            else:
                message = make(header=header, fluid_pressure=value + atmosphere, variance=0.0)
            yield stamp, name, bytes(_types().serialize_cdr(message, kind))


def read_recording(path: Path) -> Recording:
    """The channels of TOPICS that a recording has, under any namespace, and its nominal parameters.

    ExamError where the file cannot be read or has none of the channels.
    """
    samples: dict[str, list[tuple[int, float]]] = {}
    parameters: dict[str, float] = {}
    try:
        with path.open("rb") as stream:
            reader = make_reader(stream)
            for record in reader.iter_metadata():
                if record.name == PARAMETERS_RECORD:
                    parameters |= _numbers(record.metadata)
            for schema, channel, message in reader.iter_messages(log_time_order=False):
                name = _channel_of(channel.topic)
                if name and schema is not None and schema.name == TOPICS[name][1]:
                    content = _types().deserialize_cdr(message.data, schema.name)
                    samples.setdefault(name, []).append(_sample(content, schema.name, message.log_time))
    except (OSError, McapError) as error:
        raise ExamError(f"{path}: cannot be read ({error}); give a whole MCAP file") from error
    if not samples:
        raise ExamError(f"{path}: has none of the topics {', '.join(topic for topic, _ in TOPICS.values())}")
    atmosphere = parameters.get("atmospheric_pressure", STANDARD_ATMOSPHERE)
    start = min(stamp for rows in samples.values() for stamp, _ in rows)
    return Recording({name: _arrays(name, samples[name], start, atmosphere) for name in TOPICS if name in samples},
                     parameters)  # fmt: skip


def _channel_of(topic: str) -> str | None:
    return next((name for name, (end, _) in TOPICS.items() if f"/{topic}".endswith(f"/{end}")), None)


def _sample(content: Any, kind: str, logged: int) -> tuple[int, float]:
    """Stamp [ns] and value of a message; one without a header is stamped by the recorder."""
    if kind == FLOAT:
        return logged, float(content.data)
    stamp = content.header.stamp.sec * 10**9 + content.header.stamp.nanosec
    return stamp, float(content.position[0] if kind == JOINTS else content.fluid_pressure)


def _arrays(name: str, rows: list[tuple[int, float]], start: int, atmosphere: float) -> tuple[Array, Array]:
    """Time and value in order of the stamps, the first of equal ones."""
    stamps, first = np.unique(np.array([stamp for stamp, _ in rows], dtype=np.int64), return_index=True)
    values = np.array([value for _, value in rows])[first]
    return (stamps - start) / 1e9, values - atmosphere if name.startswith("pressure") else values


def _numbers(texts: Mapping[str, str]) -> dict[str, float]:
    numbers = {}
    for name, text in texts.items():
        try:
            numbers[name] = float(text)
        except ValueError:  # the kind of a part, say
            continue
    return numbers
