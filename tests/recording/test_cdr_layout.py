"""The layout of a message, judged by rosbags' own reader: every number and text lies where it says."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from eha_core.recording import encode
from eha_core.recording.cdr_layout import MOST_PARTS, layout_of

STORE = get_typestore(Stores.ROS2_JAZZY)
PACKAGES = ("sensor_msgs", "geometry_msgs", "nav_msgs", "trajectory_msgs", "diagnostic_msgs", "std_msgs")
TYPES = [name for name in STORE.fielddefs if name.partition("/")[0] in PACKAGES]


def some(generator: np.random.Generator, kind: tuple[Any, Any]) -> Any:
    """A value of a field, with texts and sequences of any length, none included."""
    what, detail = kind
    if what == Nodetype.NAME:
        fields = STORE.fielddefs[detail][1]
        return STORE.types[detail](**{name: some(generator, field) for name, field in fields})
    if what == Nodetype.BASE:
        if detail[0] == "string":
            return "ab é" * int(generator.integers(3)) + "x" * int(generator.integers(4))
        if detail[0] == "bool":
            return bool(generator.integers(2))
        return float(generator.normal()) if "float" in detail[0] else int(generator.integers(100))
    element, count = detail
    count = count if what == Nodetype.ARRAY else int(generator.integers(4))
    if element[0] == Nodetype.BASE and element[1][0] != "string":
        kind_name = "uint8" if element[1][0] in ("byte", "char", "octet") else element[1][0]
        return generator.integers(2 if kind_name == "bool" else 100, size=count).astype(kind_name)
    return [some(generator, element) for _ in range(count)]


def parts(value: Any, kind: tuple[Any, Any], path: str) -> dict[str, Any]:
    """Every number and text of a message by its path, taken from rosbags' object."""
    what, detail = kind
    if what == Nodetype.NAME:
        found: dict[str, Any] = {}
        for name, field in STORE.fielddefs[detail][1]:
            found |= parts(getattr(value, name), field, f"{path}.{name}".lstrip("."))
        return found
    if what == Nodetype.BASE or (detail[0][0] == Nodetype.BASE and detail[0][1][0] != "string"):
        return {path: value}
    found = {}
    for index, one in enumerate(value):
        found |= parts(one, detail[0], f"{path}[{index}]")
    return found


@pytest.mark.parametrize("little", [True, False], ids=["little endian", "big endian"])
def test_every_part_of_every_type_lies_where_the_layout_says(little: bool) -> None:
    generator = np.random.default_rng(5)
    compared = 0
    for type_name in TYPES:
        for _ in range(3):
            message = some(generator, (Nodetype.NAME, type_name))
            data = bytes(STORE.serialize_cdr(message, type_name, little_endian=little))
            layout = layout_of(STORE, type_name, data)
            read = parts(STORE.deserialize_cdr(data, type_name), (Nodetype.NAME, type_name), "")
            assert set(read) == set(layout.runs) | set(layout.texts)
            for path, value in read.items():
                compared += 1
                if path in layout.texts:
                    assert layout.texts[path] == value
                    continue
                run = layout.runs[path]
                numbers = np.frombuffer(data, run.kind, 1 if run.count is None else run.count, run.offset)
                np.testing.assert_array_equal(numbers if run.count is not None else numbers[0], value)
    assert compared > 1000


def test_messages_that_differ_in_their_numbers_alone_agree_in_the_marks_and_others_do_not() -> None:
    def joints(names: list[str], frame: str, position: list[float]) -> bytes:
        stamp = STORE.types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
        header = STORE.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)
        empty = np.zeros(0)
        message = STORE.types["sensor_msgs/msg/JointState"](
            header=header, name=names, position=np.array(position), velocity=empty, effort=empty
        )
        return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/JointState"))

    one = joints(["piston"], "base", [1.0])
    layout = layout_of(STORE, "sensor_msgs/msg/JointState", one)

    def alike(other: bytes) -> bool:
        return len(other) == layout.length and all(one[place] == other[place] for place in layout.marks)

    assert alike(joints(["piston"], "base", [math.pi]))
    assert alike(joints(["piston"], "hook", [1.0]))
    assert not alike(joints(["piston"], "ba", [1.0]))
    assert not alike(joints(["pis", ""], "base", [1.0]))


@pytest.mark.parametrize("cut", [1, 4, 7, 11])
def test_what_ends_early_or_late_is_no_message(cut: int) -> None:
    data = bytes(STORE.serialize_cdr(STORE.types["std_msgs/msg/Float64"](data=1.0), "std_msgs/msg/Float64"))
    with pytest.raises(ValueError, match="no std_msgs/msg/Float64|ends early"):
        layout_of(STORE, "std_msgs/msg/Float64", data[:cut])
    with pytest.raises(ValueError, match="of which it takes 12"):
        layout_of(STORE, "std_msgs/msg/Float64", data + b"\0" * 4)


def test_a_length_that_claims_the_world_is_refused_before_it_is_walked() -> None:
    claims = b"\0\1\0\0" + b"\0" * 8 + b"\1\0\0\0\0\0\0\0" + b"\xff\xff\xff\x7f"
    with pytest.raises(ValueError, match="has 2147483647 elements|ends early"):
        layout_of(STORE, "sensor_msgs/msg/JointState", claims)
    assert MOST_PARTS < 1e5


@pytest.mark.parametrize(
    ("count", "message"), [(16378, ""), (16379, "more than 16384 parts"), (16385, "name has 16385")]
)
def test_a_message_has_16384_parts_at_most(count: int, message: str) -> None:
    """Joints' names, beside which a message of joints has six."""
    data = encode("sensor_msgs/msg/JointState", {"name": ["a"] * count})
    if not message:
        assert len(layout_of(STORE, "sensor_msgs/msg/JointState", data).texts) == count + 1
    else:
        with pytest.raises(ValueError, match=message):
            layout_of(STORE, "sensor_msgs/msg/JointState", data)
