"""Parameters: name, type and value, and their messages."""

from __future__ import annotations

import array
from enum import Enum
from typing import Any

from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue

from rclpy_dds import bounded_yaml

PARAMETER_SEPARATOR_STRING = "."
_LISTS = (list, tuple, array.array)


class Parameter:
    """One parameter."""

    class Type(Enum):
        """The types a parameter can have."""

        NOT_SET = ParameterType.PARAMETER_NOT_SET
        BOOL = ParameterType.PARAMETER_BOOL
        INTEGER = ParameterType.PARAMETER_INTEGER
        DOUBLE = ParameterType.PARAMETER_DOUBLE
        STRING = ParameterType.PARAMETER_STRING
        BYTE_ARRAY = ParameterType.PARAMETER_BYTE_ARRAY
        BOOL_ARRAY = ParameterType.PARAMETER_BOOL_ARRAY
        INTEGER_ARRAY = ParameterType.PARAMETER_INTEGER_ARRAY
        DOUBLE_ARRAY = ParameterType.PARAMETER_DOUBLE_ARRAY
        STRING_ARRAY = ParameterType.PARAMETER_STRING_ARRAY

        @classmethod
        def from_parameter_value(cls, parameter_value: Any) -> Parameter.Type:
            """Return the type of a Python value.

            Raises:
                TypeError: no parameter can have that value.
            """
            if parameter_value is None:
                return cls.NOT_SET
            for python, kind in ((bool, cls.BOOL), (int, cls.INTEGER), (float, cls.DOUBLE), (str, cls.STRING)):
                if isinstance(parameter_value, python):
                    return kind
            if not isinstance(parameter_value, _LISTS):
                raise TypeError(f"The given value is not one of the allowed types '{parameter_value}'.")
            for item_type, kind in (
                (bytes, cls.BYTE_ARRAY),
                (bool, cls.BOOL_ARRAY),
                (int, cls.INTEGER_ARRAY),
                (float, cls.DOUBLE_ARRAY),
                (str, cls.STRING_ARRAY),
            ):
                if all(isinstance(item, item_type) for item in parameter_value):
                    return kind
            raise TypeError(f"The given value is not a list of one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Tell whether a Python value is of this type."""
            if self is Parameter.Type.NOT_SET:
                return parameter_value is None
            python, is_list = _PYTHON_TYPES[self.name]
            if not is_list:
                return isinstance(parameter_value, python)
            if not isinstance(parameter_value, _LISTS if python in (int, float) else (list, tuple)):
                return False
            one_byte = python is not bytes or all(len(item) == 1 for item in parameter_value)
            return one_byte and all(isinstance(item, python) for item in parameter_value)

    def __init__(self, name: str, type_: Type | None = None, value: Any = None) -> None:
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._type_ = type_
        self._name = name
        self._value = value

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """Return the parameter of an rcl_interfaces/msg/Parameter."""
        kind = Parameter.Type(param_msg.value.type)
        value = getattr(param_msg.value, _VALUE_FIELDS[kind.name]) if kind is not Parameter.Type.NOT_SET else None
        return cls(param_msg.name, kind, value)

    @property
    def name(self) -> str:
        """Return the name."""
        return self._name

    @property
    def type_(self) -> Type:
        """Return the type."""
        return self._type_

    @property
    def value(self) -> Any:
        """Return the value."""
        return self._value

    def get_parameter_value(self) -> Any:
        """Return type and value as rcl_interfaces/msg/ParameterValue."""
        message = ParameterValue(type=self._type_.value)
        if self._type_ is not Parameter.Type.NOT_SET:
            setattr(message, _VALUE_FIELDS[self._type_.name], self._value)
        return message

    def to_parameter_msg(self) -> Any:
        """Return the parameter as rcl_interfaces/msg/Parameter."""
        return ParameterMessage(name=self._name, value=self.get_parameter_value())


_PYTHON_TYPES: dict[str, tuple[type, bool]] = {
    "BOOL": (bool, False), "INTEGER": (int, False), "DOUBLE": (float, False), "STRING": (str, False),
    "BYTE_ARRAY": (bytes, True), "BOOL_ARRAY": (bool, True), "INTEGER_ARRAY": (int, True),
    "DOUBLE_ARRAY": (float, True), "STRING_ARRAY": (str, True),
}  # fmt: skip
_VALUE_FIELDS = {name: f"{name.lower()}_value" for name in _PYTHON_TYPES}


def get_parameter_value(string_value: str) -> Any:
    """Return the parameter value that a text means, its type guessed as YAML does.

    Unlike PyYAML, `1e-10` is a number here, as it is in parameters files read by ROS 2 itself.
    """
    try:
        loaded = bounded_yaml.load(string_value)
    except bounded_yaml.YamlError:
        loaded = string_value
    if isinstance(loaded, list) and loaded:
        try:
            kind = Parameter.Type.from_parameter_value(loaded)
        except TypeError:
            loaded = string_value
    elif not isinstance(loaded, (bool, int, float, str, list)):
        loaded = string_value
    if isinstance(loaded, list) and not loaded:
        kind = Parameter.Type.BOOL_ARRAY
    else:
        kind = Parameter.Type.from_parameter_value(loaded)
    return Parameter("", kind, loaded).get_parameter_value()


def parameter_value_to_python(parameter_value: Any) -> Any:
    """Return the Python value of an rcl_interfaces/msg/ParameterValue, None for NOT_SET.

    Raises:
        RuntimeError: its type is no parameter type.
    """
    try:
        kind = Parameter.Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if kind is Parameter.Type.NOT_SET:
        return None
    value = getattr(parameter_value, _VALUE_FIELDS[kind.name])
    return list(value) if kind.name.endswith("ARRAY") else value


def parameter_dict_from_yaml_file(
    parameter_file: str, use_wildcard: bool = False, target_nodes: list[str] | None = None, namespace: str = ""
) -> dict[str, Any]:
    """Return the parameters of a YAML file by name, as rcl_interfaces/msg/Parameter.

    Args:
        parameter_file: path of the file.
        use_wildcard: take what stands under `/**` too.
        target_nodes: the nodes to take parameters of; all when None.
        namespace: put before every name.

    Raises:
        RuntimeError: a node is not in the file, or the file is no parameters file.
    """
    content = bounded_yaml.load_file(parameter_file)
    keys = ["/**"] if use_wildcard and "/**" in content else []
    for node in target_nodes or ():
        if node not in content:
            raise RuntimeError(f"Param file does not contain parameters for {node},only for nodes: {list(content)} ")
        keys.append(node)
    if not target_nodes:
        keys.extend(key for key in content if key != "/**")
    if not keys:
        raise RuntimeError("Param file does not contain selected parameters")
    merged: dict[str, Any] = {}
    for key in keys:
        if not isinstance(content[key], dict) or "ros__parameters" not in content[key]:
            raise RuntimeError(f"YAML file is not a valid ROS parameter file for node {key}")
        merged.update(content[key]["ros__parameters"])
    return _unpack_parameter_dict(namespace, merged)


def _unpack_parameter_dict(namespace: str, parameter_dict: dict[str, Any]) -> dict[str, Any]:
    parameters: dict[str, Any] = {}
    for name, value in parameter_dict.items():
        full_name = f"{namespace}{name}"
        if isinstance(value, dict):
            parameters.update(_unpack_parameter_dict(f"{full_name}{PARAMETER_SEPARATOR_STRING}", value))
        else:
            parameters[full_name] = ParameterMessage(name=full_name, value=get_parameter_value(str(value)))
    return parameters
