"""Reading MCAP recordings, a single file or a folder with metadata.yaml."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader
from mcap.records import Channel, Message, Schema

from rclpy_dds import bounded_yaml


class RecordingError(ValueError):
    """A recording that cannot be read; the message names it and says why."""


@dataclass
class Recording:
    """What a recording holds: files, topics with their types and counts, first and last time (ns)."""

    path: str
    files: list[str]
    topics: dict[str, TopicSummary] = field(default_factory=dict)
    start: int = 0
    end: int = 0
    distribution: str = "unknown"

    @property
    def count(self) -> int:
        """Return the number of messages."""
        return sum(topic.count for topic in self.topics.values())

    @property
    def size(self) -> int:
        """Return the files' size in bytes."""
        return sum(os.path.getsize(file) for file in self.files)


@dataclass
class TopicSummary:
    """One topic of a recording."""

    type: str
    encoding: str
    count: int = 0


def find_files(path: str) -> list[str]:
    """Return the MCAP files of a recording in order.

    Raises:
        RecordingError: there are none.
    """
    if os.path.isfile(path):
        return [path]
    if not os.path.isdir(path):
        raise RecordingError(f"bag path '{path}' does not exist")
    information = _metadata(path)
    if information.get("storage_identifier", "mcap") != "mcap":
        raise RecordingError(f"{path} is stored as {information['storage_identifier']}; rclpy_dds reads mcap only")
    names = list(information.get("relative_file_paths", []))
    names = names or sorted(name for name in os.listdir(path) if name.endswith(".mcap"))
    if not names:
        raise RecordingError(f"{path} holds no .mcap file")
    return [os.path.join(path, name) for name in names]


def _metadata(path: str) -> dict[str, Any]:
    """Return what a recording's metadata.yaml says; nothing where there is none."""
    file_name = os.path.join(path, "metadata.yaml")
    if not os.path.isfile(file_name):
        return {}
    try:
        return dict(bounded_yaml.load_file(file_name)["rosbag2_bagfile_information"])
    except bounded_yaml.YamlError:
        return {}  # its files are found by their names; this layer's recorder once wrote aliases
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise RecordingError(f"{file_name} is no metadata of rosbag2: {error}") from None


def summarise(path: str) -> Recording:
    """Return what a recording holds; a file without a summary, as a killed recorder leaves it, is read through.

    Raises:
        RecordingError: a file is no recording.
    """
    files = find_files(path)
    recording = Recording(path, files)
    recording.distribution = _metadata(path).get("ros_distro") or recording.distribution
    starts, ends = [], []
    for name in files:
        times = _summarise_file(name, recording)
        if times is not None:
            starts.append(times[0])
            ends.append(times[1])
    recording.start, recording.end = min(starts, default=0), max(ends, default=0)
    return recording


def _summarise_file(name: str, recording: Recording) -> tuple[int, int] | None:
    """Add a file's topics and return its first and last time, None when it holds no messages."""
    with _opened(name) as file:
        try:
            reader = make_reader(file)
            summary = reader.get_summary()
            recording.distribution = _distribution(reader) or recording.distribution
        except McapError:
            summary = None
        if summary is not None and summary.statistics is not None:
            counts = summary.statistics.channel_message_counts
            for channel in summary.channels.values():
                topic = _topic(recording, summary.schemas.get(channel.schema_id), channel)
                topic.count += counts.get(channel.id, 0)
            statistics = summary.statistics
            return (statistics.message_start_time, statistics.message_end_time) if statistics.message_count else None
        times: tuple[int, int] | None = None
        file.seek(0)
        for schema, channel, message in _sequential(name, file):
            _topic(recording, schema, channel).count += 1
            first, last = times or (message.log_time, message.log_time)
            times = min(first, message.log_time), max(last, message.log_time)
        return times


def _distribution(reader: Any) -> str:
    for record in reader.iter_metadata():
        if record.name == "rosbag2" and (text := record.metadata.get("ROS_DISTRO")):
            return str(text)
    return ""


def _topic(recording: Recording, schema: Schema | None, channel: Channel) -> TopicSummary:
    kind = schema.name if schema is not None else ""
    return recording.topics.setdefault(channel.topic, TopicSummary(kind, channel.message_encoding))


def messages(path: str) -> Iterator[tuple[Schema | None, Channel, Message]]:
    """Yield schema, channel and message in the order of log times, file after file.

    Raises:
        RecordingError: a file is no recording. Damage at a file's end ends that file.
    """
    for name in find_files(path):
        with _opened(name) as file:
            try:
                indexed = make_reader(file).get_summary() is not None
            except McapError:
                indexed = False
            file.seek(0)
            yield from make_reader(file).iter_messages() if indexed else _sequential(name, file)


def _sequential(name: str, file: Any) -> Iterator[tuple[Schema | None, Channel, Message]]:
    started = False
    try:
        for entry in NonSeekingReader(file).iter_messages(log_time_order=False):
            started = True
            yield entry
    except (McapError, EOFError, ValueError) as error:
        if not started:
            detail = f": {error}" if str(error) else ""
            raise RecordingError(
                f"{name} is no MCAP recording, or was cut short before its first whole chunk{detail}"
            ) from None


def _opened(name: str) -> Any:
    try:
        return open(name, "rb")
    except OSError as error:
        raise RecordingError(f"cannot read {name}: {error.strerror}") from None
