"""Writes recordings: MCAP with the profile `ros2`, as `ros2 bag` does, that stay readable if the process is killed."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import IO, Any, NamedTuple, cast

from mcap.writer import CompressionType, Writer

from eha_core.errors import RecordingError
from eha_core.recording.crash_safe_file import CrashSafeFile
from eha_core.recording.message_types import definition_of, encode
from eha_core.recording.own_thread import OwnThread

PARAMETERS_RECORD = "eha_parameters"
_FOREVER = "{sec: 9223372036, nsec: 854775807}"


def free_path(folder: Path, prefix: str, name: str = "") -> Path:
    """Where a new recording of that name goes, numbered where there is one already; by default the name is `prefix`
    with the date and time."""
    stem = name or f"{prefix}_{datetime.now():%Y_%m_%d-%H_%M_%S}"
    path, count = folder / f"{stem}.mcap", 0
    while path.exists():
        count += 1
        path = folder / f"{stem}-{count}.mcap"
    return path


@dataclass(frozen=True)
class OfferedQuality:
    """The quality of service that a topic's publisher offers; `ros2 bag play` publishes with the same."""

    reliability: str = "reliable"
    durability: str = "volatile"
    depth: int = 10

    def as_yaml(self) -> str:
        """The text that `ros2 bag` keeps in a channel's `offered_qos_profiles`."""
        return (
            f"- history: keep_last\n  depth: {self.depth}\n  reliability: {self.reliability}\n"
            f"  durability: {self.durability}\n  deadline: {_FOREVER}\n  lifespan: {_FOREVER}\n"
            f"  liveliness: automatic\n  liveliness_lease_duration: {_FOREVER}\n"
            "  avoid_ros_namespace_conventions: false"
        )


class _Message(NamedTuple):
    topic: str
    type_name: str
    data: bytes
    stamp: int
    quality: OfferedQuality


class RecordingWriter:
    """Writes one recording; a context manager.

    Messages are collected in a chunk, which is written to disk when a message arrives later than `flush_period` after
    the last flush, or when the owner calls `flush`: a node does so on a timer, because topics may become silent. After
    each flush the file is a complete MCAP, so that `kill -9` only loses later messages. All methods that access the
    disk raise RecordingError; flushed data stay readable. A thread of its own writes the file, because Python raises
    KeyboardInterrupt anywhere in the main thread, and half a record would damage its chunk.

    Args:
        path: the .mcap file to create; its folder is made, an existing file is never overwritten.
        parameters: the parameters in force (name -> SI value), stored as the metadata record `eha_parameters`.
        flush_period: longest time that messages wait in memory [s].
    """

    def __init__(
        self, path: str | Path, parameters: Mapping[str, object] | None = None, flush_period: float = 0.5
    ) -> None:
        self.path = Path(path)
        self.message_count = 0
        self._first_path = self.path
        self._parameters = dict(parameters or {})
        self._flush_period = flush_period
        self._splits = 0
        self._open()

    def _open(self) -> None:
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            if self.path.exists():
                raise RecordingError(f"{self.path}: exists already; choose another name or remove it")
            self._file = CrashSafeFile(self.path)
        except OSError as error:
            raise RecordingError(f"{self.path}: cannot be written ({error.strerror}: {error.filename})") from error
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._waiting: deque[_Message] = deque()
        self._thread = OwnThread("recording")
        self._writer: Any = Writer(cast("IO[Any]", self._file), compression=CompressionType.ZSTD)
        self._thread.do(lambda: self._writer.start(profile="ros2"))
        self._is_open = True
        if self._parameters:
            self.add_parameters(self._parameters)
        self.flush()

    def add_parameters(self, parameters: Mapping[str, object]) -> None:
        """Store the parameters in force (name -> SI value) in the file, and in those after a split."""
        self._parameters.update(parameters)
        self.add_record(PARAMETERS_RECORD, {name: str(value) for name, value in parameters.items()})

    def add_record(self, name: str, content: Mapping[str, str]) -> None:
        """Store a metadata record in the file."""
        self._thread.do(lambda: self._writer.add_metadata(name, dict(content)))

    def write(self, topic: str, type_name: str, data: bytes, stamp: int, quality: OfferedQuality | None = None) -> None:
        """Add a serialised message.

        Args:
            topic: full topic name, with its namespace.
            type_name: "package/msg/Name".
            data: CDR bytes with their encapsulation header.
            stamp: log time [ns].
            quality: that of the publisher; only the one with a topic's first message counts.
        """
        if not self._is_open:
            raise RecordingError(f"{self.path}: the recording is closed")
        if topic not in self._channels:
            definition_of(type_name)  # an unknown type is refused here, not when it is written
        self._waiting.append(_Message(topic, type_name, data, stamp, quality or OfferedQuality()))
        self.message_count += 1
        if time.monotonic() - self._flush_time > self._flush_period:
            self.flush()

    def write_fields(
        self, topic: str, type_name: str, fields: Mapping[str, Any], stamp: int, quality: OfferedQuality | None = None
    ) -> None:
        """Add a message given by its fields (nested mappings and sequences), as `write` does for bytes."""
        self.write(topic, type_name, encode(type_name, fields), stamp, quality)

    def _put(self) -> None:
        """Add the waiting messages to the chunk in progress."""
        while self._waiting:
            topic, type_name, data, stamp, quality = self._waiting.popleft()
            channel = self._channels.get(topic) or self._register(topic, type_name, quality)
            self._writer.add_message(channel, log_time=stamp, data=data, publish_time=stamp)

    def _put_and_flush(self) -> None:
        self._put()
        self._writer.flush()

    def _register(self, topic: str, type_name: str, quality: OfferedQuality) -> int:
        definition, type_hash = definition_of(type_name)
        if type_name not in self._schemas:
            self._schemas[type_name] = self._writer.register_schema(type_name, "ros2msg", definition.encode())
        self._channels[topic] = self._writer.register_channel(
            topic,
            "cdr",
            self._schemas[type_name],
            {"offered_qos_profiles": quality.as_yaml(), "topic_type_hash": type_hash},
        )
        return self._channels[topic]

    def flush(self) -> None:
        """Close the chunk in progress and write it to disk."""
        self._flush_time = time.monotonic()
        if not self._is_open:
            return
        try:
            self._thread.do(self._put_and_flush)
        except OSError as error:
            self.abandon()
            raise RecordingError(f"{self.path}: recording stopped ({error.strerror})") from error

    def split(self) -> Path:
        """Finish this file, continue in `<name>_1.mcap`, `<name>_2.mcap`, ... and return the path of the new file."""
        self.close()
        self._splits += 1
        self.path = self._first_path.with_name(f"{self._first_path.stem}_{self._splits}{self._first_path.suffix}")
        self._open()
        return self.path

    def close(self) -> None:
        """Write the summary and close the file; nothing happens when it is closed already."""
        if not self._is_open:
            return
        self._is_open = False
        try:
            self._thread.do(self._finish)
        except OSError as error:
            raise RecordingError(f"{self.path}: the end could not be written ({error.strerror})") from error
        finally:
            self._thread.end()

    def _finish(self) -> None:
        self._put()
        self._writer.finish()
        self._file.close()

    def abandon(self) -> None:
        """Close the file as of its last flush, without a summary."""
        if self._is_open:
            self._is_open = False
            self._thread.do(self._file.discard)
            self._thread.end()

    def __enter__(self) -> RecordingWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
