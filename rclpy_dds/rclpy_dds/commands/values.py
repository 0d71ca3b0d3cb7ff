"""Messages from YAML and to YAML, as ros2 prints and reads them."""

from __future__ import annotations

import array
import time
from typing import Any

import numpy
import yaml

from rclpy_dds import bounded_yaml
from rclpy_dds.errors import CommandError
from rclpy_dds.interfaces.message import Message, interface_class, message_class

DEFAULT_TRUNCATE_LENGTH = 128


def load_class(name: str, kind: str) -> Any:
    """Return the class of a type named on the command line; `kind` is msg or srv.

    Raises:
        CommandError: there is no such type.
    """
    parts = name.split("/")
    try:
        if len(parts) == 2:
            parts.insert(1, kind)
        if len(parts) != 3 or parts[1] != kind or not all(parts):
            raise LookupError
        return interface_class("/".join(parts))
    except (LookupError, ValueError) as error:
        detail = f": {error}" if str(error) else ""
        raise CommandError(
            f"The passed {'message' if kind == 'msg' else 'service'} type is invalid: {name!r}{detail}"
        ) from None


def load_values(text: str) -> dict[str, Any]:
    """Return the dictionary a YAML text holds.

    Raises:
        CommandError: it holds none.
    """
    try:
        values = bounded_yaml.load(text)
    except bounded_yaml.YamlError as error:
        raise CommandError(f"The passed value: {error}") from None
    if values is None:
        return {}
    if not isinstance(values, dict):
        raise CommandError("The passed value needs to be a dictionary in YAML format")
    return values


def fill(message: Message, values: dict[str, Any]) -> Message:
    """Set a message's fields from nested dictionaries; a Header may be `auto`, a Time `now`.

    Raises:
        CommandError: a field does not exist or a value does not fit.
    """
    types = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in types:
            raise CommandError(f"Failed to populate field: '{type(message).__name__}' object has no attribute '{name}'")
        try:
            setattr(message, name, _converted(types[name], getattr(message, name), value))
        except (TypeError, ValueError, AssertionError, OverflowError) as error:
            raise CommandError(f"Failed to populate field: {name}: {error}") from None
    return message


def _converted(kind: str, current: Any, value: Any) -> Any:
    if isinstance(current, Message):
        if current.__ros_name__ == "std_msgs/msg/Header" and value == "auto":
            header: Any = current
            header.stamp = _now(header.stamp)
            return header
        if current.__ros_name__ == "builtin_interfaces/msg/Time" and value == "now":
            return _now(current)
        if not isinstance(value, dict):
            raise ValueError(f"needs a dictionary, not {value!r}")
        return fill(current, value)
    if isinstance(current, list):
        element = kind.removeprefix("sequence<").removesuffix(">").split(",")[0].split("[")[0]
        if not isinstance(value, list):
            raise ValueError(f"needs a list, not {value!r}")
        if "/" in element:
            package, short = element.split("/")
            return [fill(message_class(f"{package}/msg/{short}")(), item) for item in value]
        return [_scalar(element, item) for item in value]
    if isinstance(current, (array.array, numpy.ndarray)):
        if not isinstance(value, (list, tuple)):
            raise ValueError(f"needs a list, not {value!r}")
        if isinstance(current, numpy.ndarray):
            if len(value) != len(current):
                raise ValueError(f"needs {len(current)} elements, not {len(value)}")
            return numpy.array(value, dtype=current.dtype)
        return array.array(current.typecode, value)
    return _scalar(kind, value)


def _scalar(kind: str, value: Any) -> Any:
    if kind == "boolean":
        if not isinstance(value, (bool, int)):
            raise ValueError(f"needs true or false, not {value!r}")
        return bool(value)
    if kind.startswith(("string", "wstring")):
        return value if isinstance(value, str) else str(value)
    if kind in ("float", "double"):
        return float(value)
    if kind == "octet":
        return bytes([value]) if isinstance(value, int) else bytes(str(value), "latin-1")
    if isinstance(value, float) and not value.is_integer():
        raise ValueError(f"needs a whole number, not {value!r}")
    return int(value)


def _now(stamp: Any) -> Any:
    stamp.sec, stamp.nanosec = divmod(time.time_ns(), 10**9)
    return stamp


def to_plain(
    value: Any, truncate: int | None = None, no_arr: bool = False, no_str: bool = False, kind: str = ""
) -> Any:
    """Return a message as dictionaries, lists and scalars for printing."""
    if isinstance(value, Message):
        types = value.get_fields_and_field_types()
        return {name: to_plain(getattr(value, name), truncate, no_arr, no_str, types[name]) for name in types}
    if isinstance(value, bytes):
        return value.decode("latin-1")
    if isinstance(value, str):
        if no_str:
            return f"<string length: <{len(value)}>>"
        return value[:truncate] + "..." if truncate is not None and len(value) > truncate else value
    if isinstance(value, (list, tuple, array.array, numpy.ndarray)):
        if no_arr:
            return f"<array type: {kind}>" if kind else "<array>"
        items = value.tolist() if isinstance(value, (array.array, numpy.ndarray)) else value
        shown = [to_plain(item, truncate, no_arr, no_str) for item in items[:truncate]]
        return [*shown, "..."] if truncate is not None and len(items) > truncate else shown
    return value


def to_yaml(message: Any, *, flow_style: bool = False, **options: Any) -> str:
    """Return a message as the YAML that `ros2 topic echo` prints."""
    plain = to_plain(message, **options)
    return yaml.dump(
        plain, allow_unicode=True, sort_keys=False, width=2**31, default_flow_style=None if flow_style else False
    )


def to_csv(message: Any, **options: Any) -> str:
    """Return a message's values separated by commas."""

    def flat(value: Any) -> list[str]:
        if isinstance(value, dict):
            return [text for item in value.values() for text in flat(item)]
        if isinstance(value, list):
            return [text for item in value for text in flat(item)]
        return [str(value)]

    return ",".join(flat(to_plain(message, **options)))
