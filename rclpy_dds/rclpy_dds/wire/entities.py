"""DDS entities by handle: serialised bytes in and out, waiting on many at once.

Cyclone DDS's own Python classes keep every entity in a global table and deserialise in Python; the layer
needs neither, so it calls the library's C functions for what is short-lived or frequent.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from cyclonedds._clayer import ddspy_topic_create, ddspy_write
from cyclonedds.core import DDSException
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.qos import Qos, _CQos

from rclpy_dds.wire.domain import open_domain

INFINITY = 2**63 - 1
DATA_STATES = 0x7F  # any sample, view and instance state
STATUS_IDS = {
    "offered_deadline_missed": 1, "requested_deadline_missed": 2, "offered_incompatible_qos": 3,
    "requested_incompatible_qos": 4, "sample_lost": 5, "liveliness_lost": 9, "liveliness_changed": 10,
    "publication_matched": 11, "subscription_matched": 12,
}  # fmt: skip
IDLE_TOPICS = 100  # a node has about twenty
_library = DDS._dll_handle
_sertypes: dict[tuple[int, Any], int] = {}
_topics_lock = threading.Lock()


def _function(name: str, *arguments: Any) -> Any:
    # By index, not by attribute: that one is the object on which cyclonedds's own classes declare their arguments.
    function = _library[name]
    function.argtypes, function.restype = arguments, ctypes.c_int32
    return function


_entity, _pointer, _handle = ctypes.c_int32, ctypes.c_void_p, ctypes.c_uint64
_create_participant = _function("dds_create_participant", ctypes.c_uint32, _pointer, _pointer)
_create_topic = _function("dds_create_topic_sertype", _entity, ctypes.c_char_p, *[_pointer] * 4)
_get_sertype = _function("dds_get_entity_sertype", _entity, _pointer)
_reference_sertype = _function("ddsi_sertype_ref", _pointer)
_create_publisher = _function("dds_create_publisher", _entity, _pointer, _pointer)
_create_subscriber = _function("dds_create_subscriber", _entity, _pointer, _pointer)
_create_writer = _function("dds_create_writer", _entity, _entity, _pointer, _pointer)
_create_reader = _function("dds_create_reader", _entity, _entity, _pointer, _pointer)
_create_readcondition = _function("dds_create_readcondition", _entity, ctypes.c_uint32)
_create_guard = _function("dds_create_guardcondition", _entity)
_create_waitset = _function("dds_create_waitset", _entity)
_set_guard = _function("dds_set_guardcondition", _entity, ctypes.c_bool)
_attach = _function("dds_waitset_attach", _entity, _entity, ctypes.c_ssize_t)
_detach = _function("dds_waitset_detach", _entity, _entity)
_wait = _function("dds_waitset_wait", _entity, ctypes.POINTER(ctypes.c_ssize_t), ctypes.c_size_t, ctypes.c_int64)
_take = _function("dds_take_mask", _entity, _pointer, _pointer, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_uint32)
_free = _function("dds_free", _pointer)
_delete = _function("dds_delete", _entity)
_get_guid = _function("dds_get_guid", _entity, ctypes.POINTER(dds_c_t.guid))
_set_status_mask = _function("dds_set_status_mask", _entity, ctypes.c_uint32)
_wait_for_acks = _function("dds_wait_for_acks", _entity, ctypes.c_int64)
_assert_liveliness = _function("dds_assert_liveliness", _entity)
_matched_subscriptions = _function("dds_get_matched_subscriptions", _entity, _pointer, ctypes.c_size_t)
_matched_publications = _function("dds_get_matched_publications", _entity, _pointer, ctypes.c_size_t)


class EntityError(RuntimeError):
    """A DDS call failed; the message names the call and Cyclone DDS's reason."""


def checked(result: int, what: str) -> int:
    """Return a result that is no error code.

    Raises:
        EntityError: it is one.
    """
    if result < 0:
        raise EntityError(f"{what}: {DDSException(result).msg}")
    return result


def delete(entity: int) -> None:
    """Delete an entity and what belongs to it. One that is gone already, with its participant, is no error."""
    _delete(entity)


def guid(entity: int) -> bytes:
    """Return the 16 bytes by which other participants know the entity."""
    value = dds_c_t.guid()
    checked(_get_guid(entity, ctypes.byref(value)), "cannot read an entity's guid")
    return bytes(value.v)


def matched(entity: int, *, writer: bool) -> int:
    """Return how many readers a writer, or writers a reader, is matched with."""
    return max(0, (_matched_subscriptions if writer else _matched_publications)(entity, None, 0))


def matched_handles(entity: int, *, writer: bool) -> list[int]:
    """Return the instance handles of the endpoints a writer or reader is matched with."""
    function = _matched_subscriptions if writer else _matched_publications
    capacity = max(0, function(entity, None, 0))
    handles = (ctypes.c_uint64 * max(1, capacity))()
    return list(handles[: max(0, min(function(entity, handles, capacity), capacity))])


class Topic(NamedTuple):
    """A topic's entity and what it was made of."""

    handle: int
    name: str
    data_type: Any


class Participant:
    """One DDS participant with the publisher, subscriber and topics every node of a context shares."""

    def __init__(self, domain_id: int, qos: Qos) -> None:
        self._domain_id = domain_id
        self._owns_domain = open_domain(domain_id) is not None
        self._idle_topics: list[Topic] = []
        self.handle = _with_qos(qos, lambda q: _create_participant(domain_id, q, None), "cannot create a participant")
        self.publisher = checked(_create_publisher(self.handle, None, None), "cannot create a publisher")
        self.subscriber = checked(_create_subscriber(self.handle, None, None), "cannot create a subscriber")

    def topic(self, name: str, data_type: Any) -> Topic:
        """Return a topic for one endpoint, which leaves it when it goes."""
        with _topics_lock:
            for idle in self._idle_topics:
                if idle[1:] == (name, data_type):
                    self._idle_topics.remove(idle)
                    return idle
            return Topic(checked(self._new_topic(name, data_type), f"cannot create topic {name}"), name, data_type)

    def leave_topic(self, topic: Topic) -> None:
        """Keep a topic for the next endpoint of its name and type: one that is deleted gives up its number for good."""
        with _topics_lock:
            self._idle_topics.append(topic)
            if len(self._idle_topics) > IDLE_TOPICS:
                delete(self._idle_topics.pop(0).handle)

    def _new_topic(self, name: str, data_type: Any) -> int:
        """Create a topic; returns its handle or an error code.

        All topics of a type share its sertype, what Cyclone DDS holds of a type, which stays as long as the domain.
        cyclonedds makes only the first topic, as for each further one it would describe the type anew and lose the
        description in use. A sertype for every topic is no way out: Cyclone DDS's table of them has room for 32 of
        one name, and grows without end for the next.
        """
        key = self._domain_id, data_type
        if key not in _sertypes:
            topic: int = ddspy_topic_create(self.handle, name, data_type, None, None)
            if topic > 0 and self._owns_domain:  # the sertypes of a domain that the program opened may go with it
                sertype = ctypes.c_void_p()
                checked(_get_sertype(topic, ctypes.byref(sertype)), "cannot read a topic's type")
                _reference_sertype(sertype)
                _sertypes[key] = sertype.value or 0
            return topic
        _reference_sertype(_sertypes[key])  # the topic takes this reference and drops it when it is deleted
        sertype = ctypes.c_void_p(_sertypes[key])
        created: int = _create_topic(self.handle, name.encode(), ctypes.byref(sertype), None, None, None)
        return created

    def writer(self, topic: int, qos: Qos) -> int:
        """Create a writer of serialised samples."""
        return _with_qos(qos, lambda q: _create_writer(self.publisher, topic, q, None), "cannot create a writer")

    def reader(self, topic: int, qos: Qos | None) -> int:
        """Create a reader of serialised samples, or of one of Cyclone DDS's own topics."""
        return _with_qos(qos, lambda q: _create_reader(self.subscriber, topic, q, None), "cannot create a reader")

    def read_condition(self, reader: int) -> int:
        """Create a condition that holds while the reader has samples."""
        return checked(_create_readcondition(reader, DATA_STATES), "cannot create a read condition")


def _with_qos(qos: Qos | None, create: Any, what: str) -> int:
    if qos is None:
        return checked(create(None), what)
    c_qos = _CQos.qos_to_cqos(qos)
    try:
        return checked(create(c_qos), what)
    finally:
        _CQos.cqos_destroy(c_qos)


def write(writer: int, data: bytes) -> None:
    """Write one serialised sample, header included.

    Raises:
        EntityError: the sample does not fit the writer's type, or the writer is gone.
    """
    result = ddspy_write(writer, data)
    if result < 0:
        checked(result, "cannot publish")


class _Bytes(ctypes.Structure):
    """Where cyclonedds's types put a taken sample: memory that the taker frees."""

    _fields_ = (("start", _pointer), ("size", ctypes.c_size_t))


def take(reader: int) -> tuple[bytes, Any] | None:
    """Take the next sample as (bytes, dds_c_t.sample_info); None when there is none or the reader is gone.

    cyclonedds's own way in C calls back into Python for each sample and crashes when a signal's handler raises there.
    """
    sample, info = _Bytes(), dds_c_t.sample_info()
    if _take(reader, ctypes.byref(_pointer(ctypes.addressof(sample))), ctypes.byref(info), 1, 1, DATA_STATES) <= 0:
        return None
    data = ctypes.string_at(sample.start, sample.size)
    _free(sample.start)
    return data, info


def take_all(reader: int) -> Iterator[tuple[bytes, Any]]:
    """Take samples until there is none left."""
    while taken := take(reader):
        yield taken


def wait_for_acks(entity: int, nanoseconds: int) -> bool:
    """Wait until every reliable reader has everything; False when the time ran out first."""
    result = _wait_for_acks(entity, nanoseconds)
    if result == DDSException.DDS_RETCODE_TIMEOUT:
        return False
    checked(result, "cannot wait for acknowledgements")
    return True


def assert_liveliness(entity: int) -> None:
    """Say that a writer is alive."""
    checked(_assert_liveliness(entity), "cannot assert liveliness")


def status(entity: int, kind: str) -> Any:
    """Return a writer's or reader's status structure of that kind and clear its change."""
    structure = getattr(dds_c_t, f"{kind}_status")()
    function = _function(f"dds_get_{kind}_status", _entity, _pointer)
    checked(function(entity, ctypes.byref(structure)), f"cannot read status {kind}")
    return structure


def enable_statuses(entity: int, kinds: Iterable[str]) -> None:
    """Let exactly these statuses trigger a wait set the entity is attached to."""
    mask = sum(1 << STATUS_IDS[kind] for kind in kinds)
    checked(_set_status_mask(entity, mask), "cannot enable statuses")


class Guard:
    """A condition that is set and cleared by hand; setting it ends the waits it takes part in."""

    def __init__(self, participant: int) -> None:
        self.handle = checked(_create_guard(participant), "cannot create a guard condition")

    def set(self, value: bool) -> None:
        """Set or clear the condition; after deletion this does nothing."""
        _set_guard(self.handle, value)

    def delete(self) -> None:
        """Delete the condition."""
        _delete(self.handle)


class WaitSet:
    """Waits for any of many conditions and tells which hold."""

    def __init__(self, participant: int) -> None:
        self.handle = checked(_create_waitset(participant), "cannot create a wait set")
        self._capacity = 0
        self._grow(32)

    def _grow(self, capacity: int) -> None:
        if capacity > self._capacity:
            self._capacity = 2 * capacity
            self._keys = (ctypes.c_ssize_t * self._capacity)()

    def attach(self, entity: int, key: int) -> None:
        """Attach an entity; `key` is what wait returns for it."""
        checked(_attach(self.handle, entity, key), "cannot attach to a wait set")
        self._grow(max(key + 1, 32))

    def detach(self, entity: int) -> None:
        """Detach an entity; one that is gone already is no error."""
        _detach(self.handle, entity)

    def wait(self, nanoseconds: int) -> list[int]:
        """Return the keys of the conditions that hold, empty after the time ran out or when the set is gone."""
        count = _wait(self.handle, self._keys, self._capacity, nanoseconds)
        return self._keys[: min(count, self._capacity)] if count > 0 else []

    def delete(self) -> None:
        """Delete the wait set."""
        _delete(self.handle)
