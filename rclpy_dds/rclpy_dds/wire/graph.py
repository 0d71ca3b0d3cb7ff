"""Who is there: nodes and endpoints of the domain, and this process's own entry among them.

Nodes announce themselves on `ros_discovery_info`; endpoints come from DDS discovery. Both are folded into plain
dictionaries when somebody asks.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from typing import Any

from cyclonedds._clayer import ddspy_take_endpoint, ddspy_take_participant
from cyclonedds.qos import Policy, Qos

from rclpy_dds.interfaces.codec import MalformedSample, decoder, encoder
from rclpy_dds.interfaces.message import message_class
from rclpy_dds.wire import entities
from rclpy_dds.wire.discovered import discovered_qos
from rclpy_dds.wire.hashes import type_hash
from rclpy_dds.wire.interruptions import held_off
from rclpy_dds.wire.types import topic_type

_INFO = "rmw_dds_common/msg/ParticipantEntitiesInfo"
_BUILTIN_PARTICIPANTS, _BUILTIN_WRITERS, _BUILTIN_READERS = 0x7FFF0001, 0x7FFF0003, 0x7FFF0004
_COMMON = (
    Policy.Reliability.Reliable(entities.INFINITY),
    Policy.Durability.TransientLocal,
    Policy.DurabilityService(0, Policy.History.KeepLast(1), -1, -1, -1),
    Policy.DataRepresentation(use_cdrv0_representation=True),
    Policy.WriterDataLifecycle(autodispose=False),
    Policy.IgnoreLocal.Nothing,
)


@dataclass(frozen=True)
class Endpoint:
    """One writer or reader of the domain, as DDS discovery tells it."""

    gid: bytes
    participant: bytes
    topic: str
    type: str
    qos: Qos


@dataclass
class NodeEntry:
    """One node of this process as others shall see it."""

    name: str
    namespace: str
    readers: list[bytes] = field(default_factory=list)
    writers: list[bytes] = field(default_factory=list)


class Graph:
    """The domain as one participant sees it."""

    def __init__(self, participant: entities.Participant) -> None:
        self._lock = threading.RLock()
        self.gid = entities.guid(participant.handle)
        topic = participant.topic("ros_discovery_info", topic_type(_INFO))
        announced = Policy.Userdata(f"typehash={type_hash(_INFO)};".encode("ascii"))
        self._writer = participant.writer(topic.handle, Qos(*_COMMON, announced, Policy.History.KeepLast(1)))
        self._reader = participant.reader(topic.handle, Qos(*_COMMON, announced, Policy.History.KeepAll))
        self._participant_reader = participant.reader(_BUILTIN_PARTICIPANTS, None)
        self._endpoint_readers = (
            participant.reader(_BUILTIN_WRITERS, None),
            participant.reader(_BUILTIN_READERS, None),
        )
        readers = (self._reader, self._participant_reader, *self._endpoint_readers)
        self.conditions = [participant.read_condition(reader) for reader in readers]
        self._own: list[NodeEntry] = []
        self._participants: dict[bytes, list[Any]] = {}
        self._alive: dict[bytes, str] = {}
        self._endpoints: tuple[dict[bytes, Endpoint], dict[bytes, Endpoint]] = ({}, {})

    # What this process announces

    def add_node(self, name: str, namespace: str) -> NodeEntry:
        """Announce a node and return its entry."""
        entry = NodeEntry(name, namespace)
        with self._lock:
            self._own.append(entry)
            self._announce()
        return entry

    def remove_node(self, entry: NodeEntry) -> None:
        """Withdraw a node."""
        with self._lock:
            self._own = [own for own in self._own if own is not entry]
            self._announce()
            self.fold()

    def add_endpoints(self, entry: NodeEntry, *, readers: tuple[int, ...] = (), writers: tuple[int, ...] = ()) -> None:
        """Announce endpoints of a node, given by entity handle."""
        with self._lock:
            entry.readers += [entities.guid(handle) for handle in readers]
            entry.writers += [entities.guid(handle) for handle in writers]
            self._announce()

    def remove_endpoints(self, entry: NodeEntry, gids: set[bytes]) -> None:
        """Withdraw endpoints of a node."""
        with self._lock:
            entry.readers = [gid for gid in entry.readers if gid not in gids]
            entry.writers = [gid for gid in entry.writers if gid not in gids]
            self._announce()

    def _announce(self) -> None:
        gid_class = message_class("rmw_dds_common/msg/Gid")
        node_class = message_class("rmw_dds_common/msg/NodeEntitiesInfo")
        message = message_class(_INFO)(
            gid=gid_class(data=list(self.gid)),
            node_entities_info_seq=[
                node_class(
                    node_namespace=entry.namespace,
                    node_name=entry.name,
                    reader_gid_seq=[gid_class(data=list(gid)) for gid in entry.readers],
                    writer_gid_seq=[gid_class(data=list(gid)) for gid in entry.writers],
                )
                for entry in self._own
            ],
        )
        entities.write(self._writer, encoder(_INFO)(message))

    # What is known of the domain

    def fold(self) -> None:
        """Take in what discovery has queued up; what nobody takes would be kept for ever."""
        self._infos()
        self._take_endpoints(0)
        self._take_endpoints(1)

    def nodes(self) -> list[tuple[str, str, str]]:
        """Return (name, namespace, enclave) of every node."""
        return [(info.node_name, info.node_namespace, enclave) for info, enclave in self._infos()]

    def node_gids(self, name: str, namespace: str) -> tuple[set[bytes], set[bytes]] | None:
        """Return the gids of a node's readers and writers, None when there is no such node."""
        found = [i for i, _ in self._infos() if (i.node_name, i.node_namespace) == (name, namespace)]
        if not found:
            return None
        readers = {bytes(gid.data) for info in found for gid in info.reader_gid_seq}
        return readers, {bytes(gid.data) for info in found for gid in info.writer_gid_seq}

    def owners(self) -> dict[bytes, tuple[str, str]]:
        """Return the (name, namespace) behind every endpoint's gid."""
        found = {}
        for info, _ in self._infos():
            for gid in (*info.reader_gid_seq, *info.writer_gid_seq):
                found[bytes(gid.data)] = (info.node_name, info.node_namespace)
        return found

    def settled(self) -> bool:
        """Return whether every participant that was discovered has announced its endpoints and its nodes.

        Fast DDS tells both up to 3 s, its period of heartbeats, after its participant was discovered.
        """
        with self._lock:
            owned = self.owners().keys()
            endpoints = [*self.writers(), *self.readers()]
            have_endpoints = {endpoint.participant for endpoint in endpoints}
            tell_nodes = {endpoint.participant for endpoint in endpoints if endpoint.topic == "ros_discovery_info"}
            return (
                self._alive.keys() <= have_endpoints
                and tell_nodes <= self._participants.keys()
                and owned <= {endpoint.gid for endpoint in endpoints}
            )

    def writers(self) -> list[Endpoint]:
        """Return every writer of the domain."""
        return self._take_endpoints(0)

    def readers(self) -> list[Endpoint]:
        """Return every reader of the domain."""
        return self._take_endpoints(1)

    def _infos(self) -> list[tuple[Any, str]]:
        with self._lock:
            # Whose entry has come was discovered before it, so who is not there after this is gone already.
            newest = {i.publication_handle: data for data, i in entities.take_all(self._reader) if i.valid_data}
            self._take_participants()
            for data in newest.values():
                try:
                    message = decoder(_INFO)(data)
                except MalformedSample:
                    continue  # a participant of another make; its nodes stay unknown
                gid = bytes(message.gid.data)
                if gid in self._alive:
                    self._participants[gid] = message.node_entities_info_seq
            return [(info, self._alive[gid]) for gid, infos in self._participants.items() for info in infos]

    def _take_participants(self) -> None:
        for key, qos, info in _take(ddspy_take_participant, self._participant_reader, lambda k, q, i: (k, q, i)):
            if info.instance_state == 16 and qos is not None:
                self._alive[key] = _enclave(qos)
            else:
                self._alive.pop(key, None)
                self._participants.pop(key, None)

    def _take_endpoints(self, which: int) -> list[Endpoint]:
        def construct(
            key: bytes, participant: bytes, _: int, topic: str, type_name: str, qos: Any, info: Any, __: Any
        ) -> tuple[Endpoint, Any]:
            return Endpoint(key, participant, topic, type_name, qos), info

        with self._lock:
            known = self._endpoints[which]
            for endpoint, info in _take(ddspy_take_endpoint, self._endpoint_readers[which], construct):
                if info.instance_state == 16 and info.valid_data:
                    known[endpoint.gid] = endpoint
                else:
                    known.pop(endpoint.gid, None)
            return list(known.values())


@held_off()
def _take(function: Any, reader: int, construct: Any) -> list[Any]:
    found: list[Any] = []
    while True:
        taken = function(reader, 256, construct, discovered_qos)
        if type(taken) is int:
            return found
        found += taken
        if len(taken) < 256:
            return found


def _enclave(qos: Qos) -> str:
    data = qos[Policy.Userdata].data if Policy.Userdata in qos else b""
    for part in data.decode("ascii", "replace").split(";"):
        if part.startswith("enclave="):
            return part[8:]
    return ""
