"""Definitions of messages: how they are read and found, and what is not offered."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from contract.conftest import Program


@pytest.mark.parametrize(
    "text", ["float64", "float64 1x", "Float64[ x", "int8 A=text", "float64 x\nfloat64 x", "nonsense x y"]
)
def test_an_unparsable_definition_names_type_and_line(text: str) -> None:
    from rclpy_dds.interfaces.definition import DefinitionError, parse_message

    with pytest.raises(DefinitionError, match=r"some_msgs/msg/Bad, line \d"):
        parse_message("some_msgs/msg/Bad", text)


def test_definitions_hold_defaults_bounds_and_constants() -> None:
    from rclpy_dds.interfaces.definition import Constant, Field, FieldType, parse_message

    text = (
        "# head\nint8 LOW=-5\nstring NAME='a#b'  # text\nfloat64[3] x [1, 2.5, -3]\n"
        "string<=4[<=2] words\nHeader header\nbool on true\n"
    )
    definition = parse_message("some_msgs/msg/Some", text)
    assert definition.constants == (Constant("LOW", "int8", -5), Constant("NAME", "string", "a#b"))
    assert definition.fields == (
        Field("x", FieldType("float64", "array", 3), [1.0, 2.5, -3.0]),
        Field("words", FieldType("string", "sequence", 2, 4)),
        Field("header", FieldType("std_msgs/msg/Header")),
        Field("on", FieldType("bool"), True),
    )


def test_what_is_not_offered_says_so_at_import() -> None:
    for module in ("action", "lifecycle", "service_introspection"):
        with pytest.raises(ImportError, match="install ROS 2"):
            __import__(f"rclpy.{module}")


def test_messages_of_a_package_are_found_where_it_is_installed(
    program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    share = tmp_path / "share" / "found_msgs"
    for folder, name, text in (
        ("msg", "Found.msg", "int8 LOW=-5\nfloat64[3] x [1, 2.5, -3]\nstd_msgs/Header header\n"),
        ("srv", "Ask.srv", "string word\n---\nfound_msgs/Found answer\n"),
    ):
        (share / folder).mkdir(parents=True)
        (share / folder / name).write_text(text)
    before = os.environ.get("AMENT_PREFIX_PATH")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{before}" if before else str(tmp_path))
    source = """
from found_msgs.msg import Found
from found_msgs.srv import Ask
from rclpy.serialization import deserialize_message, serialize_message
sent = Ask.Response(answer=Found(x=[4.0, 5.0, 6.0]))
sent.answer.header.frame_id = "rig"
assert deserialize_message(serialize_message(sent), Ask.Response) == sent
print("found", Found().x.tolist(), Found.LOW, sent.answer.header.frame_id)
"""
    assert program(source).wait_for("found").strip() == "found [1.0, 2.5, -3.0] -5 rig"
