"""Where definitions come from: .msg and .srv files of installed packages, then the rosbags type store."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from functools import cache
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from rclpy_dds.interfaces.definition import Constant, Definition, Field, FieldType, parse_message, parse_service
from rclpy_dds.interfaces.folders import SHARE, interface_folders, prefixes

# The type store keeps no defaults; these are the only fields of its packages that have one.
_DEFAULTS = {("geometry_msgs/msg/Quaternion", "w"): 1.0}


class UnknownInterface(LookupError):
    """No definition of that name in any package; the message says where was looked."""


@cache
def typestore() -> Any:
    """Return the rosbags store of the distribution whose API the layer follows."""
    return get_typestore(Stores.ROS2_JAZZY)


def package_names() -> set[str]:
    """Return every package that has message or service definitions."""
    names = {name.split("/")[0] for name in typestore().fielddefs}
    for prefix in (*prefixes(), SHARE):
        share = os.path.join(prefix, "share")
        if os.path.isdir(share):
            names.update(name for name in os.listdir(share) if interface_folders(name))
    return names


def interface_names(package: str, kind: str) -> list[str]:
    """Return the names of a package's messages (kind "msg") or services ("srv")."""
    names = {n.split("/")[2] for n in typestore().fielddefs if n.startswith(f"{package}/{kind}/") and kind == "msg"}
    for folder in interface_folders(package):
        path = os.path.join(folder, kind)
        if os.path.isdir(path):
            names.update(name[:-4] for name in os.listdir(path) if name.endswith(f".{kind}"))
    return sorted(names)


_recorded: dict[str, str] = {}


def add_recorded(name: str, schema: str) -> None:
    """Make the types of a recording's `ros2msg` schema known where no installed package has them."""
    head, *parts = re.split(r"^={80}\r?\nMSG: ([\w/]+)\r?\n", schema, flags=re.MULTILINE)
    _recorded.setdefault(name, head)
    for inner, text in zip(parts[::2], parts[1::2], strict=True):
        package, short = inner.split("/")[0], inner.split("/")[-1]
        _recorded.setdefault(f"{package}/msg/{short}", text)


@cache
def message(name: str) -> Definition:
    """Return the definition of `package/msg/Name`, or of a service's part `package/srv/Name_Request`.

    Raises:
        UnknownInterface: nothing of that name is installed.
        DefinitionError: its file cannot be parsed.
    """
    package, kind, short = name.split("/")
    if kind == "srv":
        service_name, _, part = name.rpartition("_")
        if part == "Event":
            return _event(service_name)
        return service(service_name)[part == "Response"]
    text = _file_text(package, kind, short)
    if text is not None:
        return parse_message(name, text)
    if name not in typestore().fielddefs:
        if name in _recorded:
            return parse_message(name, _recorded[name])
        raise UnknownInterface(
            f"no message {name}: not in the type store and no {package}/msg/{short}.msg in {_where()}"
        )
    constants, fields = typestore().fielddefs[name]
    return Definition(
        name,
        tuple(Field(field, _field_type(spec), _DEFAULTS.get((name, field))) for field, spec in fields),
        tuple(Constant(n, base, bytes([value]) if base == "byte" else value) for n, base, value in constants),
    )


@cache
def service(name: str) -> tuple[Definition, Definition]:
    """Return request and response of the service `package/srv/Name`.

    Raises:
        UnknownInterface: nothing of that name is installed.
        DefinitionError: its file cannot be parsed.
    """
    package, kind, short = name.split("/")
    text = _file_text(package, kind, short)
    if text is None:
        raise UnknownInterface(f"no service {name}: no {package}/srv/{short}.srv in {_where()}")
    return parse_service(name, text)


def _event(service_name: str) -> Definition:
    """Return the introspection event of a service; only type hashes need it."""
    parts = [FieldType(f"{service_name}_{part}", "sequence", 1) for part in ("Request", "Response")]
    info = Field("info", FieldType("service_msgs/msg/ServiceEventInfo"))
    return Definition(f"{service_name}_Event", (info, Field("request", parts[0]), Field("response", parts[1])))


def _where() -> str:
    return ", ".join(os.path.join(prefix, "share") for prefix in prefixes())


def _file_text(package: str, kind: str, short: str) -> str | None:
    for folder in interface_folders(package):
        path = os.path.join(folder, kind, f"{short}.{kind}")
        if os.path.isfile(path):
            with open(path, encoding="utf-8") as file:
                return file.read()
    return None


def _field_type(spec: Any) -> FieldType:
    node, argument = spec
    if node == Nodetype.NAME:
        return FieldType(argument)
    if node == Nodetype.BASE:
        return FieldType(argument[0], "", 0, argument[1])
    element, size = argument
    return replace(_field_type(element), container="array" if node == Nodetype.ARRAY else "sequence", size=size)
