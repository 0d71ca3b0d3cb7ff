"""Definitions as .msg text, for recordings and for showing them."""

from __future__ import annotations

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import Constant, Definition, FieldType

_SEPARATOR = "=" * 80


def message_text(definition: Definition) -> str:
    """Return the definition's own text, or one written from it."""
    if definition.text:
        return definition.text if definition.text.endswith("\n") else f"{definition.text}\n"
    lines = [_constant(constant) for constant in definition.constants]
    lines += [f"{_type(field.type)} {field.name}" for field in definition.fields]
    return "".join(f"{line}\n" for line in lines)


def schema_text(name: str) -> str:
    """Return a message's text followed by those of every message inside, as rosbag2's `ros2msg` schemas have it."""
    parts: dict[str, str] = {}

    def collect(message: str) -> None:
        if message in parts:
            return
        definition = store.message(message)
        parts[message] = message_text(definition)
        for field in definition.fields:
            if field.type.is_message:
                collect(field.type.base)

    collect(name)
    inner = [f"{_SEPARATOR}\nMSG: {key.replace('/msg/', '/')}\n{text}" for key, text in parts.items() if key != name]
    return "".join([parts[name], *inner])


def _constant(constant: Constant) -> str:
    value = constant.value[0] if isinstance(constant.value, bytes) else constant.value
    return f"{constant.base} {constant.name}={value}"


def _type(kind: FieldType) -> str:
    base = kind.base.replace("/msg/", "/") + (f"<={kind.string_bound}" if kind.string_bound else "")
    if not kind.container:
        return base
    size = str(kind.size) if kind.size else ""
    return f"{base}[{'<=' if kind.container == 'sequence' and kind.size else ''}{size}]"
