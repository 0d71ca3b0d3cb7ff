"""Publishing to a topic."""

from __future__ import annotations

from typing import Any

from rclpy.dds_qos import to_dds
from rclpy.duration import Duration
from rclpy.endpoint import Endpoint
from rclpy.exceptions import InvalidHandle, RCLError
from rclpy.qos import QoSProfile
from rclpy_dds.interfaces.codec import encoder
from rclpy_dds.wire import entities, names
from rclpy_dds.wire.hashes import type_hash


class Publisher(Endpoint):
    """Sends messages of one type; made by Node.create_publisher."""

    def __init__(self, node: Any, msg_type: Any, topic: str, qos_profile: QoSProfile) -> None:
        super().__init__(node)
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.event_handlers: list[Any] = []
        self._encode = encoder(msg_type.__ros_name__)
        self._write = entities.write
        dds_name = topic if qos_profile.avoid_ros_namespace_conventions else names.dds_topic(topic)
        qos = to_dds(qos_profile, f"typehash={type_hash(msg_type.__ros_name__)};")
        self._entity = self._writer(dds_name, msg_type.__ros_name__, qos)
        node.context.graph.add_endpoints(self._entry, writers=(self._entity,))

    def publish(self, msg: Any) -> None:
        """Send a message, or bytes of one that is serialised already.

        Raises:
            TypeError: it is of another type. InvalidHandle: the publisher was destroyed. RCLError: DDS refuses it.
        """
        if isinstance(msg, self.msg_type):
            data = self._encode(msg)
        elif isinstance(msg, (bytes, bytearray)):
            data = bytes(msg) + b"\0" * (-len(msg) & 3)
        else:
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        if self._destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        try:
            self._write(self._entity, data)
        except entities.EntityError as error:
            raise RCLError(f"Failed to publish: {error}") from None

    def get_subscription_count(self) -> int:
        """Return how many subscriptions are matched."""
        return entities.matched(self._entity, writer=True)

    @property
    def topic_name(self) -> str:
        """Return the topic's fully qualified name."""
        return self.topic

    def assert_liveliness(self) -> None:
        """Say that this publisher is alive, for MANUAL_BY_TOPIC liveliness."""
        entities.assert_liveliness(self._entity)

    def wait_for_all_acked(self, timeout: Duration | None = None) -> bool:
        """Wait until every reliable subscription has everything; False when the time ran out first."""
        nanoseconds = entities.INFINITY if timeout is None or timeout.nanoseconds < 0 else timeout.nanoseconds
        return entities.wait_for_acks(self._entity, nanoseconds)

    def __enter__(self) -> Publisher:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()
