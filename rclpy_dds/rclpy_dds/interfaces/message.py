"""Message classes that behave as rosidl's Python ones, made from definitions at first use."""

from __future__ import annotations

import array
import os
import re
from functools import cache
from typing import Any

import numpy

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.definition import Definition, Field, FieldType

TYPE_CODES = {
    "int8": "b", "uint8": "B", "char": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
    "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
NUMPY_TYPES = {base: "uint8" if base == "char" else base for base in TYPE_CODES}
_ROSIDL_NAMES = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}
_SCALARS = {"bool": bool, "byte": bytes, "string": str, "wstring": str, "float32": float, "float64": float}
FLOAT32_MAX = 3.402823466e38


def module_name(name: str) -> str:
    """Return the module rosidl puts a type in: `JointState` lives in `_joint_state`."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return "_" + re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


class _MessageType(type):
    """Constants are read as attributes of the class and cannot be set."""

    _TYPE_SUPPORT = "rclpy_dds"

    def __setattr__(cls, name: str, value: Any) -> None:
        if name in cls.__dict__.get("__constants__", ()):
            raise AttributeError(f"{cls.__name__}.{name} is a constant")
        super().__setattr__(name, value)


class Message(metaclass=_MessageType):
    """Base of every message class."""

    __slots__ = ()
    __ros_name__: str
    _fields_and_field_types: dict[str, str]
    __array_fields__: frozenset[str]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return field names and rosidl's names of their types, in order."""
        return dict(cls._fields_and_field_types)

    def __repr__(self) -> str:
        parts = []
        for name in self._fields_and_field_types:
            value = getattr(self, name)
            in_array = name in self.__array_fields__
            parts.append(f"{name}={value.tolist() if in_array and isinstance(value, array.array) else value!r}")
        package, kind, short = self.__ros_name__.split("/")
        return f"{package}.{kind}.{short}({', '.join(parts)})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, self.__class__):
            return False
        for name in self._fields_and_field_types:
            mine, theirs = getattr(self, name), getattr(other, name)
            if isinstance(mine, numpy.ndarray):
                if not numpy.array_equal(mine, theirs):
                    return False
            elif mine != theirs:
                return False
        return True

    __hash__ = None  # type: ignore[assignment]

    def __copy__(self) -> Message:
        return self.__class__(**{name: getattr(self, name) for name in self._fields_and_field_types})


class _ServiceType(type):
    """The class of service classes."""

    _TYPE_SUPPORT = "rclpy_dds"


class Service(metaclass=_ServiceType):
    """Base of every service class: carries Request and Response."""

    Request: type[Message]
    Response: type[Message]
    __ros_name__: str

    def __init__(self) -> None:
        raise NotImplementedError("Service classes can not be instantiated")


@cache
def message_class(name: str) -> Any:
    """Return the class of `package/msg/Name`."""
    definition = store.message(name)
    package, kind, short = name.split("/")
    owner = short.removesuffix("_Request").removesuffix("_Response") if kind == "srv" else short
    fields = definition.fields
    namespace: dict[str, Any] = {
        "__slots__": [f"_{field.name}" for field in fields] + ["_check_fields"],
        "__module__": f"{package}.{kind}.{module_name(owner)}",
        "__qualname__": short,
        "__init__": _initialiser(definition),
        "__ros_name__": name,
        "_fields_and_field_types": {field.name: rosidl_type(field.type) for field in fields},
        "__array_fields__": frozenset(
            f.name for f in fields if f.type.container == "sequence" and f.type.base in TYPE_CODES
        ),
        "__constants__": frozenset(constant.name for constant in definition.constants),
    }
    namespace.update({constant.name: constant.value for constant in definition.constants})
    namespace.update({field.name: _property(field) for field in fields})
    made = _MessageType(short, (Message,), namespace)
    for field in fields:
        if field.default is not None:
            setattr(made, f"{field.name.upper()}__DEFAULT", field.default)
    return made


@cache
def service_class(name: str) -> Any:
    """Return the class of `package/srv/Name`."""
    package, kind, short = name.split("/")
    namespace = {
        "__module__": f"{package}.{kind}.{module_name(short)}",
        "__ros_name__": name,
        "Request": message_class(f"{name}_Request"),
        "Response": message_class(f"{name}_Response"),
    }
    return _ServiceType(short, (Service,), namespace)


def interface_class(name: str) -> Any:
    """Return the class of a message or service named `package/kind/Name` or `package/Name`."""
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, "msg")
    full = "/".join(parts)
    if len(parts) != 3 or parts[1] not in ("msg", "srv"):
        raise store.UnknownInterface(f"{name!r} is no type name; write package/msg/Name or package/srv/Name")
    return (
        service_class(full)
        if parts[1] == "srv" and not full.endswith(("_Request", "_Response"))
        else message_class(full)
    )


def rosidl_type(field_type: FieldType) -> str:
    """Return rosidl's spelling of a type, such as `sequence<double, 3>` or `std_msgs/Header`."""
    base = field_type.base
    text = _ROSIDL_NAMES.get(base, base.replace("/msg/", "/"))
    if field_type.string_bound:
        text = f"{text}<{field_type.string_bound}>"
    if field_type.container == "array":
        return f"{text}[{field_type.size}]"
    if field_type.container == "sequence":
        return f"sequence<{text}, {field_type.size}>" if field_type.size else f"sequence<{text}>"
    return text


def default_value(field: Field) -> Any:
    """Return a fresh default of a field."""
    kind, value = field.type, field.default
    if kind.container == "sequence":
        return array.array(TYPE_CODES[kind.base], value or []) if kind.base in TYPE_CODES else list(value or [])
    if kind.container == "array":
        if kind.base in TYPE_CODES:
            return numpy.array(value if value is not None else [0] * kind.size, dtype=NUMPY_TYPES[kind.base])
        return list(value) if value else [_zero(kind) for _ in range(kind.size)]
    return _zero(kind) if value is None else value


def _zero(kind: FieldType) -> Any:
    if kind.is_message:
        return message_class(kind.base)()
    return b"\x00" if kind.base == "byte" else _SCALARS.get(kind.base, int)()


def checks_wanted() -> bool:
    """Tell whether field checks are switched on for new messages (ROS_PYTHON_CHECK_FIELDS=1)."""
    return os.environ.get("ROS_PYTHON_CHECK_FIELDS", "") == "1"


def _initialiser(definition: Definition) -> Any:
    """Return __init__(self, **kwargs). Scalars are set inline: a message is made for every sample sent."""
    scope: dict[str, Any] = {"_checks": checks_wanted()}
    names = [field.name for field in definition.fields]
    lines = ["def __init__(self, **kwargs):", "  self._check_fields = kwargs.pop('check_fields', _checks)"]
    lines += ["  if self._check_fields:", "    for name in kwargs:", f"      if name not in {tuple(names)!r}:"]
    lines += ["        raise AssertionError('Invalid arguments passed to constructor: %s' % ', '.join(sorted(kwargs)))"]
    for field in definition.fields:
        make = f"_default_{field.name}"
        if field.type.container:
            scope[make] = lambda field=field: default_value(field)
        elif field.type.is_message:
            scope[make] = message_class(field.type.base)
        else:
            value = default_value(field)
            scope[make] = lambda value=value: value
        lines += [f"  if {field.name!r} in kwargs: self.{field.name} = kwargs[{field.name!r}]"]
        lines += [f"  else: self._{field.name} = {make}()"]
    exec("\n".join(lines), scope)
    return scope["__init__"]


def _property(field: Field) -> property:
    slot, convert, check = f"_{field.name}", _converter(field.type), _checker(field)

    def put(self: Any, value: Any) -> None:
        if self._check_fields:
            check(value)
        setattr(self, slot, convert(value) if convert else value)

    scope: dict[str, Any] = {}
    exec(f"def get(self): return self.{slot}", scope)  # twice as fast as getattr with a name
    return property(scope["get"], put, doc=f"Message field '{field.name}'.")


def _converter(kind: FieldType) -> Any:
    """Return what turns an assigned value into the stored one, None when it is stored as it is."""
    if not kind.container or kind.base not in TYPE_CODES:
        return None
    if kind.container == "sequence":
        code = TYPE_CODES[kind.base]
        return lambda value: (
            value if isinstance(value, array.array) and value.typecode == code else array.array(code, value)
        )
    dtype = numpy.dtype(NUMPY_TYPES[kind.base])

    def to_numpy(value: Any) -> numpy.ndarray[Any, Any]:
        fits = isinstance(value, numpy.ndarray) and value.dtype == dtype
        return value if fits else numpy.array(value, dtype=dtype)

    return to_numpy


def _checker(field: Field) -> Any:
    kind, name = field.type, field.name

    def check(value: Any) -> None:
        if not kind.container:
            assert _is_scalar(kind, value), f"The '{name}' field must be {_wanted(kind)}"
            return
        if isinstance(value, array.array) and kind.container == "sequence":
            assert kind.base in TYPE_CODES and value.typecode == TYPE_CODES[kind.base], (
                f"The '{name}' array.array() must have the type code of '{TYPE_CODES.get(kind.base)}'"
            )
        elif isinstance(value, numpy.ndarray) and kind.container == "array" and kind.base in TYPE_CODES:
            assert value.dtype == NUMPY_TYPES[kind.base], (
                f"The '{name}' numpy.ndarray() must have the dtype of '{kind.base}'"
            )
        else:
            assert hasattr(value, "__iter__") and hasattr(value, "__len__") and not isinstance(value, (str, dict)), (
                f"The '{name}' field must be a set or sequence of {_wanted(kind)}"
            )
            assert all(_is_scalar(kind, item) for item in value), f"The '{name}' field must hold {_wanted(kind)} only"
        if kind.container == "array":
            assert len(value) == kind.size, f"The '{name}' field must have a size of {kind.size}"
        elif kind.size:
            assert len(value) <= kind.size, f"The '{name}' field must have at most {kind.size} elements"

    return check


def _wanted(kind: FieldType) -> str:
    if kind.is_message:
        return f"a sub message of type '{kind.base.split('/')[-1]}'"
    bounds = {"float32": " of 32 bits", "byte": " of length 1"}.get(kind.base, "")
    return f"of type '{_SCALARS.get(kind.base, int).__name__}'{bounds}"


def _is_scalar(kind: FieldType, value: Any) -> bool:
    if kind.is_message:
        return isinstance(value, message_class(kind.base))
    if kind.base == "byte":
        return isinstance(value, (bytes, bytearray)) and len(value) == 1
    if kind.base == "float32":
        return isinstance(value, float) and (not -numpy.inf < value < numpy.inf or abs(value) <= FLOAT32_MAX)
    if kind.string_bound:
        return isinstance(value, str) and len(value) <= kind.string_bound
    if kind.base in _SCALARS:
        return isinstance(value, _SCALARS[kind.base])
    if not isinstance(value, int):
        return False
    limits = numpy.iinfo(NUMPY_TYPES[kind.base])
    return bool(limits.min <= value <= limits.max)
