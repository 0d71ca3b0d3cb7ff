"""What a node can ask about the others."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable
from typing import Any

from cyclonedds.qos import Policy

from rclpy.dds_qos import from_dds
from rclpy.exceptions import NodeNameNonExistentError
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from rclpy.type_hash import TypeHash
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy_dds.wire import names
from rclpy_dds.wire.graph import Endpoint

NamesAndTypes = list[tuple[str, list[str]]]


class NodeGraph:
    """Graph queries, mixed into Node."""

    context: Any

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """Return every topic with its types; with no_demangle as DDS names them, whosesoever they are."""
        graph = self.context.graph
        return _topics([*graph.writers(), *graph.readers()], no_demangle)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """Return every service with its types."""
        graph = self.context.graph
        return _services([*graph.writers(), *graph.readers()], None)

    def get_node_names(self) -> list[str]:
        """Return every node's name."""
        return [name for name, _, _ in self.context.graph.nodes()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """Return every node's name with its namespace."""
        return [f"{namespace.rstrip('/')}/{name}" for name, namespace, _ in self.context.graph.nodes()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return every node's name and namespace."""
        return [(name, namespace) for name, namespace, _ in self.context.graph.nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return every node's name, namespace and enclave."""
        return self.context.graph.nodes()

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node publishes.

        Raises:
            NodeNameNonExistentError: there is no such node.
        """
        _, writers = self._gids(node_name, node_namespace)
        return _topics([e for e in self.context.graph.writers() if e.gid in writers], no_demangle)

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """Return the topics a node subscribes to.

        Raises:
            NodeNameNonExistentError: there is no such node.
        """
        readers, _ = self._gids(node_name, node_namespace)
        return _topics([e for e in self.context.graph.readers() if e.gid in readers], no_demangle)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node offers.

        Raises:
            NodeNameNonExistentError: there is no such node.
        """
        readers, _ = self._gids(node_name, node_namespace)
        return _services([e for e in self.context.graph.readers() if e.gid in readers], names.REQUEST)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """Return the services a node has clients for.

        Raises:
            NodeNameNonExistentError: there is no such node.
        """
        _, writers = self._gids(node_name, node_namespace)
        return _services([e for e in self.context.graph.writers() if e.gid in writers], names.REQUEST)

    def _gids(self, name: str, namespace: str) -> tuple[set[bytes], set[bytes]]:
        validate_node_name(name)
        validate_namespace(namespace)
        found = self.context.graph.node_gids(name, namespace)
        if found is None:
            raise NodeNameNonExistentError(
                "Failed to get names and types by node: "
                f"cannot get node '{name}' in namespace '{namespace}': it does not exist"
            )
        return found

    def count_publishers(self, topic_name: str) -> int:
        """Return how many publishers a topic has."""
        dds_name = names.dds_topic(self._full_name(topic_name, is_service=False))
        return sum(endpoint.topic == dds_name for endpoint in self.context.graph.writers())

    def count_subscribers(self, topic_name: str) -> int:
        """Return how many subscriptions a topic has."""
        dds_name = names.dds_topic(self._full_name(topic_name, is_service=False))
        return sum(endpoint.topic == dds_name for endpoint in self.context.graph.readers())

    def count_clients(self, service_name: str) -> int:
        """Return how many clients a service has."""
        request, _ = names.dds_service(self._full_name(service_name, is_service=True))
        return sum(endpoint.topic == request for endpoint in self.context.graph.writers())

    def count_services(self, service_name: str) -> int:
        """Return how many servers a service has."""
        request, _ = names.dds_service(self._full_name(service_name, is_service=True))
        return sum(endpoint.topic == request for endpoint in self.context.graph.readers())

    def _full_name(self, name: str, *, is_service: bool) -> str:
        resolve = self.resolve_service_name if is_service else self.resolve_topic_name  # type: ignore[attr-defined]
        full = resolve(name, only_expand=True)
        validate_full_topic_name(full, is_service=is_service)
        return full

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return what is known of every publisher of a topic."""
        return self._infos(topic_name, no_mangle, TopicEndpointTypeEnum.PUBLISHER, self.context.graph.writers())

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return what is known of every subscription of a topic."""
        return self._infos(topic_name, no_mangle, TopicEndpointTypeEnum.SUBSCRIPTION, self.context.graph.readers())

    def _infos(
        self, topic_name: str, no_mangle: bool, kind: TopicEndpointTypeEnum, endpoints: list[Endpoint]
    ) -> list[TopicEndpointInfo]:
        dds_name = topic_name
        if not no_mangle:
            full = self._full_name(topic_name, is_service=False)
            dds_name = names.dds_topic(self.resolve_topic_name(full))  # type: ignore[attr-defined]
        owners = self.context.graph.owners()
        infos = []
        for endpoint in endpoints:
            if endpoint.topic == dds_name:
                name, namespace = owners.get(endpoint.gid, ("_NODE_NAME_UNKNOWN_", "_NODE_NAMESPACE_UNKNOWN_"))
                type_name = endpoint.type if no_mangle else names.ros_type(endpoint.type)
                gid, qos = list(endpoint.gid), from_dds(endpoint.qos)
                infos.append(TopicEndpointInfo(name, namespace, type_name, _type_hash(endpoint), kind, gid, qos))
        return infos

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait until a node is there; False when the time (s) ran out."""
        end = time.monotonic() + timeout
        wanted = "/" + fully_qualified_node_name.lstrip("/")
        while self.context.ok():
            if wanted in self.get_fully_qualified_node_names():
                return True
            if time.monotonic() >= end:
                return False
            time.sleep(0.02)
        return False


def _topics(endpoints: Iterable[Endpoint], no_demangle: bool) -> NamesAndTypes:
    found: dict[str, set[str]] = {}
    for endpoint in endpoints:
        name = endpoint.topic if no_demangle else names.ros_topic(endpoint.topic)
        if name is not None:
            found.setdefault(name, set()).add(endpoint.type if no_demangle else names.ros_type(endpoint.type))
    return [(name, sorted(types)) for name, types in sorted(found.items())]


def _services(endpoints: Iterable[Endpoint], prefix: str | None) -> NamesAndTypes:
    found: dict[str, set[str]] = {}
    for endpoint in endpoints:
        name = names.ros_service(endpoint.topic)
        if name is not None and (prefix is None or endpoint.topic.startswith(f"{prefix}/")):
            found.setdefault(name, set()).add(names.ros_service_type(endpoint.type))
    return [(name, sorted(types)) for name, types in sorted(found.items())]


def _type_hash(endpoint: Endpoint) -> TypeHash:
    data = endpoint.qos[Policy.Userdata].data if Policy.Userdata in endpoint.qos else b""
    match = re.search(r"typehash=RIHS(\d\d)_([0-9a-f]{64})", data.decode("ascii", "replace"))
    return TypeHash(int(match[1]), bytes.fromhex(match[2])) if match else TypeHash()
