"""Bytes and type hashes of every message type, against rosbags, which shares nothing with ROS 2 nor with the layer."""

from __future__ import annotations

import random
from importlib import import_module
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from contract.conftest import IS_LAYER, Graph

STORE = get_typestore(Stores.ROS2_JAZZY)
NUMPY_NAMES = {"bool": "bool", "byte": "uint8", "octet": "uint8", "char": "uint8"}
FILLER = "structure_needs_at_least_one_member"  # on the wire of an empty message, and no field of its class


def _message_class(name: str) -> Any:
    """Return the class of a type, None where its package is not installed."""
    package, _, base = name.split("/")
    try:
        return getattr(import_module(f"{package}.msg"), base)
    except ImportError:
        return None


CLASSES = {name: made for name in sorted(STORE.fielddefs) if (made := _message_class(name)) is not None}


def _value(description: Any, generator: random.Random) -> Any:
    """A value of a field's type in plain Python: numbers, texts, lists, and a dictionary for a message."""
    kind, detail = description
    if kind == Nodetype.NAME:
        return {
            field: 0 if field == FILLER else _value(inner, generator) for field, inner in STORE.fielddefs[detail][1]
        }
    if kind != Nodetype.BASE:
        element, size = detail
        count = size if kind == Nodetype.ARRAY else min(generator.randrange(4), size or 9)
        return [_value(element, generator) for _ in range(count)]
    base = detail[0]
    if base in ("string", "wstring"):
        return "".join(generator.choices("aü€ ", k=generator.randrange(5)))
    if base == "bool":
        return bool(generator.randrange(2))
    return generator.randrange(400) / 4 if base.startswith("float") else generator.randrange(100)


def _for_rclpy(description: Any, value: Any) -> Any:
    """The value as a message class of rclpy takes it."""
    kind, detail = description
    if kind == Nodetype.NAME:
        message = CLASSES[detail]()
        for field, inner in STORE.fielddefs[detail][1]:
            if field == FILLER:
                continue
            made, present = _for_rclpy(inner, value[field]), getattr(message, field)
            setattr(message, field, np.array(made, present.dtype) if isinstance(present, np.ndarray) else made)
        return message
    if kind != Nodetype.BASE:
        return [_for_rclpy(detail[0], one) for one in value]
    return bytes([value]) if detail[0] in ("byte", "octet") else value


def _for_rosbags(description: Any, value: Any) -> Any:
    """The value as a message class of rosbags takes it."""
    kind, detail = description
    if kind == Nodetype.NAME:
        fields = STORE.fielddefs[detail][1]
        return STORE.types[detail](**{field: _for_rosbags(inner, value[field]) for field, inner in fields})
    if kind != Nodetype.BASE:
        inner_kind, inner = detail[0]
        made = [_for_rosbags(detail[0], one) for one in value]
        numbers = inner_kind == Nodetype.BASE and inner[0] not in ("string", "wstring")
        return np.array(made, NUMPY_NAMES.get(inner[0], inner[0])) if numbers else made
    return value


def test_most_of_the_store_s_types_are_installed() -> None:
    assert len(CLASSES) > 100


def test_bytes_agree_with_rosbags_on_every_type_and_in_both_orders() -> None:
    generator = random.Random(1)
    for name, message_class in CLASSES.items():
        whole = (Nodetype.NAME, name)
        value = _value(whole, generator)
        message, theirs = _for_rclpy(whole, value), _for_rosbags(whole, value)
        data, other = bytes(serialize_message(message)), bytes(STORE.serialize_cdr(theirs, name, little_endian=True))
        assert len(data) >= len(other), name  # filled up to what was set aside
        assert len(data) < len(other) + 4 or not IS_LAYER, name
        data = data[: len(other)]
        if not IS_LAYER:  # ROS 2's own leaves between the fields whatever was there: rosbags writes zeros
            data = bytes(STORE.serialize_cdr(STORE.deserialize_cdr(data, name), name, little_endian=True))
        assert data == other, name
        assert deserialize_message(other, message_class) == message, name
        swapped = bytes(STORE.serialize_cdr(theirs, name, little_endian=False))
        assert deserialize_message(swapped, message_class) == message, name


def test_type_hashes_agree_with_rosbags(graph: Graph) -> None:
    def has_char(name: str) -> bool:  # uint8 to ROS 2; rosbags numbers it on its own
        return any("'char'" in str(kind) or _inner(kind, has_char) for _, kind in STORE.fielddefs[name][1])

    node = graph.node("hasher")
    for number, (name, message_class) in enumerate(CLASSES.items()):
        topic = f"hashed_{number}"
        publisher = node.create_publisher(message_class, topic, 1)
        assert graph.spin_until(lambda topic=topic: node.get_publishers_info_by_topic(topic)), name
        [endpoint] = node.get_publishers_info_by_topic(topic)
        if not has_char(name):
            assert str(endpoint.topic_type_hash) == STORE.hash_rihs01(name), name
        node.destroy_publisher(publisher)


def _inner(description: Any, asked: Any) -> bool:
    """Ask about the message that a field holds, if it holds any."""
    kind, detail = description
    if kind == Nodetype.NAME:
        return bool(asked(detail))
    return kind != Nodetype.BASE and _inner(detail[0], asked)
