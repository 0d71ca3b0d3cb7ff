"""Receiving from a topic."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from enum import Enum
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.dds_qos import to_dds
from rclpy.endpoint import Endpoint
from rclpy.qos import QoSProfile
from rclpy_dds.interfaces.codec import MalformedSample, decoder
from rclpy_dds.wire import entities, names
from rclpy_dds.wire.hashes import type_hash


class Subscription(Endpoint):
    """Hands every message of a topic to a function; made by Node.create_subscription."""

    class CallbackType(Enum):
        """Whether the function takes the message alone or its info too."""

        MessageOnly = 0
        WithMessageInfo = 1

    def __init__(
        self,
        node: Any,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        raw: bool,
    ) -> None:
        super().__init__(node)
        self.msg_type = msg_type
        self.topic = topic
        self.callback = callback
        self.callback_group = callback_group
        self.qos_profile = qos_profile
        self.raw = raw
        self.event_handlers: list[Any] = []
        self._logger = node.get_logger()
        self._decode = decoder(msg_type.__ros_name__)
        dds_name = topic if qos_profile.avoid_ros_namespace_conventions else names.dds_topic(topic)
        qos = to_dds(qos_profile, f"typehash={type_hash(msg_type.__ros_name__)};")
        self._entity, self.condition = self._reader(dds_name, msg_type.__ros_name__, qos)
        node.context.graph.add_endpoints(self._entry, readers=(self._entity,))

    @property
    def callback(self) -> Callable[..., Any]:
        """Return the function messages go to."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._callback_type = Subscription.CallbackType.MessageOnly
        try:
            inspect.signature(value).bind(object())
        except TypeError:
            try:
                inspect.signature(value).bind(object(), object())
            except TypeError:
                raise RuntimeError(
                    "Subscription.__init__(): callback should be either be callable with one argument "
                    "(to get only the message) or two (to get message and message info)"
                ) from None
            self._callback_type = Subscription.CallbackType.WithMessageInfo
        except ValueError:
            pass  # built-in functions show no signature; they get the message
        self._callback = value
        self._with_info = self._callback_type is Subscription.CallbackType.WithMessageInfo

    @property
    def topic_name(self) -> str:
        """Return the topic's fully qualified name."""
        return self.topic

    def get_publisher_count(self) -> int:
        """Return how many publishers are matched."""
        return entities.matched(self._entity, writer=False)

    def _take(self) -> tuple[Any, Any] | None:
        taken = entities.take(self._entity)
        if not taken or self._destroyed:
            return None
        data, info = taken
        if not info.valid_data:
            return None
        if self.raw:
            return data, info
        try:
            return self._decode(data), info
        except MalformedSample as error:
            self._logger.error(f"dropped a malformed sample on '{self.topic}': {error}")
            return None

    def _handle(self, taken: tuple[Any, Any]) -> Any:
        if not self._with_info:
            return self._callback(taken[0])
        return self._callback(taken[0], message_info(taken[1]))

    def take_message(self, msg_type: Any = None, raw: bool = False) -> tuple[Any, dict[str, Any]] | None:
        """Take one message with its info at once, without an executor; None when there is none."""
        taken = self._take()
        return (taken[0], message_info(taken[1])) if taken else None

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()


def message_info(info: Any) -> dict[str, Any]:
    """Return what rclpy tells about a received message; DDS counts no publication sequence here."""
    return {
        "source_timestamp": info.source_timestamp,
        "received_timestamp": time.time_ns(),
        "publication_sequence_number": None,
        "reception_sequence_number": None,
    }
