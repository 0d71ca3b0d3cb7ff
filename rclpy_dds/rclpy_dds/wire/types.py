"""Definitions as Cyclone DDS types. The bytes are made by the layer's own codec; these types make topics match."""

import types
from dataclasses import dataclass
from functools import cache
from typing import Any

from cyclonedds import idl
from cyclonedds.idl import annotations
from cyclonedds.idl import types as cyclone_types

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import PLACEHOLDER, Definition, FieldType
from rclpy_dds.wire.names import dds_type

idl_types: Any = cyclone_types  # indexed like generics, which a checker does not see
_BASES = {
    "bool": bool, "byte": idl_types.uint8, "char": idl_types.uint8, "string": str,
    **{name: getattr(idl_types, name) for name in
       ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")},
}  # fmt: skip
_SERVICE_HEADER = {"guid": idl_types.uint64, "seq": idl_types.int64}


class UnsupportedType(TypeError):
    """A type the wire cannot carry here; the message names it."""


@cache
def topic_type(name: str) -> Any:
    """Return the Cyclone DDS type of the message or service part `name`, ready for a topic.

    A service's parts carry the header with which rmw_cyclonedds_cpp matches replies to requests.
    """
    made = _struct(store.message(name), with_header=name.split("/")[1] == "srv")
    made.__idl__.populate()
    made.__idl__.fill_type_data()
    return made


@cache
def _struct(definition: Definition, with_header: bool = False) -> Any:
    fields: dict[str, Any] = dict(_SERVICE_HEADER) if with_header else {}
    fields.update({field.name: _type(definition.name, field.type) for field in definition.fields})
    if not definition.fields:
        fields[PLACEHOLDER] = idl_types.uint8
    name = dds_type(definition.name)

    def body(namespace: dict[str, Any]) -> None:
        namespace["__annotations__"].update(fields)
        namespace["__module__"] = __name__

    made = types.new_class(name.replace("::", "_"), (idl.IdlStruct,), {"typename": name}, body)
    return annotations.final(dataclass(made))


def _type(owner: str, kind: FieldType) -> Any:
    if kind.base == "wstring":
        raise UnsupportedType(f"{owner} has a wstring, which Cyclone DDS for Python cannot carry; use a string")
    base = _struct(store.message(kind.base)) if kind.is_message else _BASES[kind.base]
    if kind.string_bound:
        base = idl_types.bounded_str[kind.string_bound]
    if kind.container == "array":
        return idl_types.array[base, kind.size]
    if kind.container == "sequence":
        return idl_types.sequence[base, kind.size] if kind.size else idl_types.sequence[base]
    return base
