"""Records the topics of a namespace, as they appear in the graph, without decoding them."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from pathlib import Path
from shutil import disk_usage
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from eha_core.errors import RecordingError
from eha_core.recording import OfferedQuality, RecordingWriter, definition_of, free_path
from eha_sim_node.coverage import RECORD, Coverage
from eha_sim_node.log_time import SimulatedTime, leading_stamp

_ALWAYS = ("/clock", "/diagnostics", "/parameter_events")
_DEPTH = 5000  # samples that may wait while the disk or another process has the machine
_LONGEST_WAIT = 0.25  # s that a message waits for the /clock that settles its log time
_RETRY = 5.0  # s after which a recording that was given up is begun anew
_ROOM = 2**26  # bytes that must be free for that; it would end at once otherwise, again and again
_WALL_CLOCK_HEADERS = frozenset({"diagnostic_msgs/msg/DiagnosticArray"})

Handler = Callable[[bytes], None]
Waiting = tuple[float, str, bytes, int]


class Recorder:
    """Subscribes every topic of the node's namespace and writes what arrives while a recording is open.

    A recording that cannot be written is given up with its reason in `failure`; subscriptions and handlers go on, and
    `resume` opens the next one when there is room again.

    Args:
        node: owner of the subscriptions.
        directory: where recordings go.
        name: file name without ending; empty: made from the date.
        simulated_time: whether log times are simulated time (from /clock) instead of wall-clock time.
        handlers: what else gets a topic's bytes, by full topic name.
    """

    def __init__(
        self, node: Node, directory: Path, name: str, simulated_time: bool, handlers: Mapping[str, Handler]
    ) -> None:
        self._node = node
        self._directory = directory
        self._name = name
        self._handlers = handlers
        self._time = SimulatedTime() if simulated_time else None
        self._waiting: deque[Waiting] = deque()
        self._types: dict[str, str] = {}
        self._qualities: dict[str, OfferedQuality] = {}
        self._writer: RecordingWriter | None = None
        self._parameters: dict[str, float] = {}
        self._coverage = Coverage()
        self.unrecorded: dict[str, str] = {}
        self.failure: str | None = None
        self._next_attempt = 0.0

    @property
    def path(self) -> Path | None:
        """The file being written."""
        return self._writer.path if self._writer else None

    @property
    def message_count(self) -> int:
        """Messages in the recording so far, its earlier parts included."""
        return self._writer.message_count if self._writer else 0

    @property
    def topics(self) -> Iterable[str]:
        """The topics subscribed."""
        return self._types.keys()

    def start(self, name: str = "") -> Path:
        """Open a new recording, under another name where one is given; raise RecordingError where one is open or the
        file cannot be made."""
        if self._writer:
            raise RecordingError(f"{self._writer.path} is being recorded already; stop or split it first")
        try:
            self._writer = RecordingWriter(free_path(self._directory, "eha", name or self._name), self._parameters)
        except RecordingError as error:
            self.failure = str(error)
            raise
        self.failure = None
        self._coverage = Coverage()
        return self._writer.path

    def resume(self) -> Path | None:
        """Open a new recording in place of one that was given up, if there is room and a while has passed; its path."""
        if self._writer or self.failure is None or time.monotonic() < self._next_attempt:
            return None
        self._next_attempt = time.monotonic() + _RETRY
        try:
            if disk_usage(self._directory).free < _ROOM:
                return None
            return self.start()
        except (OSError, RecordingError):
            return None

    def stop(self) -> Path:
        """Finish the recording; raise RecordingError where none is open or its end cannot be written."""
        if self._writer is None and self.failure is not None:
            self.failure = None  # whoever stops a recording that was given up wants none anew
        writer = self._open_writer()
        self._settle(everything=True)
        self._writer = None
        self._keep_coverage(writer)
        writer.close()
        return writer.path

    def split(self) -> Path:
        """Finish the file and go on in the next one; raise RecordingError as `stop` does."""
        writer = self._open_writer()
        self._settle(everything=True)
        try:
            self._keep_coverage(writer)
            return writer.split()
        except RecordingError as error:
            self._give_up(error)
            raise

    def _keep_coverage(self, writer: RecordingWriter) -> None:
        """Store in a file that is about to end what it covers."""
        writer.add_record(RECORD, self._coverage.as_record())
        self._coverage = Coverage()

    def keep_parameters(self, parameters: Mapping[str, float]) -> None:
        """Store the simulator's parameters in this recording and in those to come."""
        self._parameters = dict(parameters)
        if self._writer:
            self._guarded(lambda writer: writer.add_parameters(parameters))

    def flush(self) -> None:
        """Bring to disk what has come so far."""
        self._settle(everything=False)
        self._guarded(lambda writer: writer.flush())

    def discover(self) -> None:
        """Subscribe the topics that are new in the graph."""
        namespace = self._node.get_namespace().rstrip("/") + "/"
        for topic, types in self._node.get_topic_names_and_types():
            known = topic in self._types or topic in self.unrecorded
            hidden = topic_or_service_is_hidden(topic)
            if not known and not hidden and (topic.startswith(namespace) or topic in _ALWAYS):
                self._subscribe(topic, types[0])

    def _subscribe(self, topic: str, type_name: str) -> None:
        package, _, name = type_name.split("/")
        try:
            message_class = getattr(import_module(f"{package}.msg"), name)
            definition_of(type_name)
        except (ImportError, AttributeError, RecordingError) as error:
            self.unrecorded[topic] = str(error)
            self._node.get_logger().warning(f"{topic} is not recorded: no definition of {type_name} is installed")
            return
        profile = self._profile(topic)
        if profile is None:
            return
        self._types[topic] = type_name
        durable = profile.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL
        reliable = profile.reliability == QoSReliabilityPolicy.RELIABLE
        self._qualities[topic] = OfferedQuality(
            "reliable" if reliable else "best_effort", "transient_local" if durable else "volatile"
        )
        fields = list(message_class.get_fields_and_field_types().values())
        stamped = fields[0] == "std_msgs/Header" and type_name not in _WALL_CLOCK_HEADERS
        receive = self._receiver(topic, type_name, stamped)
        self._node.create_subscription(message_class, topic, receive, profile, raw=True)

    def _profile(self, topic: str) -> QoSProfile | None:
        """The strongest quality that every publisher of a topic offers; None while nobody publishes it."""
        offered = [info.qos_profile for info in self._node.get_publishers_info_by_topic(topic)]
        if not offered:
            return None
        reliable = all(quality.reliability == QoSReliabilityPolicy.RELIABLE for quality in offered)
        durable = all(quality.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL for quality in offered)
        return QoSProfile(
            depth=_DEPTH,
            reliability=QoSReliabilityPolicy.RELIABLE if reliable else QoSReliabilityPolicy.BEST_EFFORT,
            durability=QoSDurabilityPolicy.TRANSIENT_LOCAL if durable else QoSDurabilityPolicy.VOLATILE,
        )

    def _receiver(self, topic: str, type_name: str, stamped: bool) -> Callable[[bytes, Any], None]:
        handler = self._handlers.get(topic)
        simulated = self._time
        is_clock = type_name == "rosgraph_msgs/msg/Clock"

        def receive(data: bytes, info: Any) -> None:
            published = info["source_timestamp"] or time.time_ns()
            if simulated is None:
                self._write(topic, data, published)
            elif is_clock:
                stamp = leading_stamp(data)
                simulated.tick(published, stamp)
                self._write(topic, data, stamp)
                self._settle(everything=False)
            elif stamped:
                self._write(topic, data, leading_stamp(data))
            elif self._writer:
                self._waiting.append((time.monotonic(), topic, data, published))
            if handler is not None:
                handler(data)  # after it is written: whoever hears what came of a sample may end the node at once

        return receive

    def _settle(self, everything: bool) -> None:
        """Write the messages whose simulated time is certain, and those that waited long enough."""
        if self._time is None:
            return
        latest = time.monotonic() - _LONGEST_WAIT
        while self._waiting:
            arrived, topic, data, published = self._waiting[0]
            if not (everything or self._time.certain(published) or arrived < latest):
                return
            self._waiting.popleft()
            self._write(topic, data, self._time.at(published))

    def _write(self, topic: str, data: bytes, stamp: int) -> None:
        if self._writer:
            self._coverage.add(topic, stamp)
            self._guarded(lambda writer: writer.write(topic, self._types[topic], data, stamp, self._qualities[topic]))

    def _guarded(self, act: Callable[[RecordingWriter], None]) -> None:
        if self._writer is None:
            return
        try:
            act(self._writer)
        except RecordingError as error:
            self._give_up(error)

    def _give_up(self, error: RecordingError) -> None:
        self.failure = str(error)
        self._writer = None
        self._next_attempt = time.monotonic() + _RETRY
        self._waiting.clear()
        self._node.get_logger().error(f"recording stopped, monitoring goes on: {error}")

    def _open_writer(self) -> RecordingWriter:
        if self._writer is None:
            raise RecordingError(f"nothing is being recorded{f': {self.failure}' if self.failure else ''}")
        return self._writer
