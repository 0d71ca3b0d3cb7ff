"""Declaring a node's parameters, and forgetting them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterType, ParameterValue

from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter, parameter_value_to_python
from rclpy.validate_parameter_name import validate_parameter_name


class NodeParameterDeclaration:
    """Declaring, mixed into Node by NodeParameters."""

    _parameters: dict[str, Parameter]
    _descriptors: dict[str, Any]
    _parameter_overrides: dict[str, Parameter]
    _set_atomically: Callable[..., Any]

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare one parameter and return it.

        Args:
            name: with dots for groups.
            value: the default, or a Parameter.Type when there is none.
            descriptor: rcl_interfaces/msg/ParameterDescriptor: description, range, read-only.
            ignore_override: start with `value` whatever the command line says.

        Raises:
            ParameterAlreadyDeclaredException, InvalidParameterException, InvalidParameterValueException,
            InvalidParameterTypeException: as their names say.
        """
        if value is None and descriptor is None:
            return self.declare_parameters("", [(name,)], ignore_override)[0]
        return self.declare_parameters("", [(name, value, descriptor or ParameterDescriptor())], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several parameters, as (name), (name, value) or (name, value, descriptor).

        Raises:
            What declare_parameter raises, and TypeError or ValueError for a malformed tuple.
        """
        made: list[Parameter] = []
        descriptors: dict[str, Any] = {}
        for index, entry in enumerate(parameters):
            name, value, descriptor = self._read_declaration(namespace, index, entry)
            if not ignore_override and name in self._parameter_overrides:
                value = self._parameter_overrides[name].value
            if isinstance(value, ParameterValue):
                raise ValueError("Cannot declare a parameter from a ParameterValue message; pass a Python value")
            made.append(Parameter(name, value=value))
            descriptors[name] = descriptor
        known = [parameter.name for parameter in made if parameter.name in self._parameters]
        if known:
            raise ParameterAlreadyDeclaredException(known)
        for parameter in made:
            result = self._set_atomically([parameter], descriptors, allow_not_set_type=True)
            if result.successful:
                continue
            if result.reason.startswith("Wrong parameter type"):
                raise InvalidParameterTypeException(parameter, Parameter.Type(descriptors[parameter.name].type).name)
            raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
        return [self._parameters[parameter.name] for parameter in made]

    def _read_declaration(self, namespace: str, index: int, entry: tuple[Any, ...]) -> tuple[str, Any, Any]:
        if len(entry) < 1 or len(entry) > 3:
            raise TypeError(
                f"Invalid parameter tuple length at index {index} in parameters list: {entry}; "
                "expecting length between 1 and 3"
            )
        name = entry[0]
        if not isinstance(name, str):
            raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
        if namespace:
            name = f"{namespace}{PARAMETER_SEPARATOR_STRING}{name}"
        validate_parameter_name(name)
        value = entry[1] if len(entry) > 1 else None
        descriptor = entry[2] if len(entry) > 2 else ParameterDescriptor()
        if not isinstance(descriptor, ParameterDescriptor):
            raise TypeError(
                f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor."
            )
        if len(entry) == 1:
            warnings.warn(
                f"when declaring parameter named '{name}', "
                "declaring a parameter only providing its name is deprecated. "
                'You have to either:\n\t- Pass a name and a default value different to "PARAMETER NOT SET"'
                " (and optionally a descriptor).\n\t- Pass a name and a parameter type.\n"
                "\t- Pass a name and a descriptor with `dynamic_typing=True",
                stacklevel=4,
            )
            descriptor.dynamic_typing = True
        return name, self._fix_type(name, value, descriptor), descriptor

    @staticmethod
    def _fix_type(name: str, value: Any, descriptor: Any) -> Any:
        """Write the static type into the descriptor and return the default value."""
        if isinstance(value, Parameter.Type):
            if value is Parameter.Type.NOT_SET:
                raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
            if descriptor.dynamic_typing:
                raise ValueError(
                    f"When declaring parameter {{{name}}} passing a descriptor with"
                    "`dynamic_typing=True` is not allowed when the parameter type is provided"
                )
            descriptor.type = value.value
            return None
        if isinstance(value, ParameterValue):
            if not descriptor.dynamic_typing:
                descriptor.type = value.type
            value = parameter_value_to_python(value)
        elif not descriptor.dynamic_typing:
            descriptor.type = Parameter.Type.from_parameter_value(value).value
        if not descriptor.dynamic_typing and descriptor.type == ParameterType.PARAMETER_NOT_SET:
            raise ValueError("Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET")
        return value

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter.

        Raises:
            ParameterNotDeclaredException: there is none. ParameterImmutableException: it is read-only.
        """
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]
