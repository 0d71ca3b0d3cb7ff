"""RIHS01, the type hash ROS 2 endpoints announce: SHA-256 over the JSON of a type's description, defaults left out."""

from __future__ import annotations

import hashlib
import json
from functools import cache
from typing import Any

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import PLACEHOLDER, Field, FieldType

# type_description_interfaces/msg/FieldType numbers the elementary types; containers add an offset.
_IDS = {
    "int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9,
    "float32": 10, "float64": 11, "char": 3, "bool": 15, "byte": 16, "string": 17, "wstring": 18,
}  # fmt: skip
_NESTED, _BOUNDED_STRING, _ARRAY, _BOUNDED_SEQUENCE, _SEQUENCE = 1, 4, 48, 96, 144


@cache
def type_hash(name: str) -> str:
    """Return the hash of a message, a service or a service's part, as `RIHS01_<64 hex digits>`."""
    return f"RIHS01_{hashlib.sha256(json.dumps(description(name)).encode()).hexdigest()}"


def description(name: str) -> dict[str, Any]:
    """Return a type's description as type_description_interfaces/msg/TypeDescription spells it, defaults left out."""
    seen: dict[str, Any] = {}
    is_service = name.split("/")[1] == "srv" and not name.endswith(("_Request", "_Response", "_Event"))
    if is_service:
        parts = [
            Field(f"{part}_message", FieldType(f"{name}_{part.title()}")) for part in ("request", "response", "event")
        ]
        root = {"type_name": name, "fields": [_field(part, seen) for part in parts]}
    else:
        root = _describe(name, seen)
        del seen[name]
    return {"type_description": root, "referenced_type_descriptions": [seen[key] for key in sorted(seen)]}


def _describe(name: str, seen: dict[str, Any]) -> Any:
    if name not in seen:
        seen[name] = None  # keeps a place while the fields are walked
        fields = store.message(name).fields or (Field(PLACEHOLDER, FieldType("uint8")),)
        seen[name] = {"type_name": name, "fields": [_field(field, seen) for field in fields]}
    return seen[name]


def _field(field: Field, seen: dict[str, Any]) -> Any:
    kind = field.type
    if kind.is_message:
        _describe(kind.base, seen)
        number = _NESTED
    else:
        number = _IDS[kind.base] + (_BOUNDED_STRING if kind.string_bound else 0)
    if kind.container == "array":
        number += _ARRAY
    elif kind.container:
        number += _BOUNDED_SEQUENCE if kind.size else _SEQUENCE
    return {
        "name": field.name,
        "type": {
            "type_id": number,
            "capacity": kind.size,
            "string_capacity": kind.string_bound,
            "nested_type_name": kind.base if kind.is_message else "",
        },
    }
