"""What publishers, subscriptions, clients and services have in common: DDS entities owned by a node."""

from __future__ import annotations

from typing import Any

from rclpy.handle import Handle
from rclpy_dds.wire import entities
from rclpy_dds.wire.types import topic_type


class Endpoint:
    """Holds the DDS entities of one ROS entity and deletes them once."""

    def __init__(self, node: Any) -> None:
        self._node_context = node.context
        self._participant = node.context.participant
        self._entry = node._graph_entry
        self._gids: set[bytes] = set()
        self._owned: list[int] = []
        self._topics: list[entities.Topic] = []
        self._lifetime = Handle(self, self._delete)
        self._event_kinds: set[str] = set()

    def _topic(self, name: str, type_name: str) -> int:
        self._topics.append(self._participant.topic(name, topic_type(type_name)))
        return self._topics[-1].handle

    def _reader(self, topic: str, type_name: str, qos: Any) -> tuple[int, int]:
        """Create a reader and its read condition; returns both."""
        reader = self._participant.reader(self._topic(topic, type_name), qos)
        self._owned.append(reader)
        self._gids.add(entities.guid(reader))
        entities.enable_statuses(reader, ())
        return reader, self._participant.read_condition(reader)

    def _writer(self, topic: str, type_name: str, qos: Any) -> int:
        """Create a writer."""
        writer = self._participant.writer(self._topic(topic, type_name), qos)
        self._owned.append(writer)
        self._gids.add(entities.guid(writer))
        entities.enable_statuses(writer, ())
        return writer

    @property
    def handle(self) -> Handle:
        """Return the handle; `with entity.handle:` puts destruction off until the end of the block."""
        return self._lifetime

    @property
    def _destroyed(self) -> bool:
        return self._lifetime.destroyed

    def destroy(self) -> None:
        """Delete the entities and withdraw them from the graph."""
        self._lifetime.destroy_when_not_in_use()

    def _delete(self) -> None:
        graph = self._node_context._graph
        if graph is not None:
            graph.remove_endpoints(self._entry, self._gids)
            for entity in self._owned:
                entities.delete(entity)
            for topic in self._topics:
                self._participant.leave_topic(topic)
        self._node_context.changed()
