"""Reading a node's parameters and what describes them."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import ListParametersResult, ParameterDescriptor

from rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

DEPTH_RECURSIVE = 0


class NodeParameterReading:
    """Reading, mixed into Node by NodeParameters."""

    _parameters: dict[str, Parameter]
    _descriptors: dict[str, Any]
    _allow_undeclared_parameters: bool

    def has_parameter(self, name: str) -> bool:
        """Tell whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; NOT_SET for an undeclared one where those are allowed.

        Raises:
            ParameterNotDeclaredException: it is not declared. ParameterUninitializedException: it has no value.
        """
        if name in self._parameters:
            parameter = self._parameters[name]
            if parameter.type_ is not Parameter.Type.NOT_SET or self._descriptors[name].dynamic_typing:
                return parameter
            raise ParameterUninitializedException(name)
        if self._allow_undeclared_parameters:
            return Parameter(name, Parameter.Type.NOT_SET, None)
        raise ParameterNotDeclaredException(name)

    def get_parameters(self, names: list[str]) -> list[Parameter]:
        """Return several parameters; raises what get_parameter raises."""
        _check_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative where there is none or it has no value."""
        if alternative_value is None:
            alternative_value = Parameter(name, Parameter.Type.NOT_SET)
        if name not in self._parameters:
            return alternative_value
        parameter = self._parameters[name]
        return alternative_value if parameter.type_ is Parameter.Type.NOT_SET else parameter

    def get_parameter_type(self, name: str) -> Any:
        """Return a parameter's type as a number; NOT_SET for an undeclared one where those are allowed.

        Raises:
            ParameterNotDeclaredException: it is not declared.
        """
        if name in self._parameters:
            return self._parameters[name].type_.value
        if self._allow_undeclared_parameters:
            return Parameter.Type.NOT_SET
        raise ParameterNotDeclaredException(name)

    def get_parameter_types(self, names: list[str]) -> list[Any]:
        """Return several parameters' types; raises what get_parameter_type raises."""
        _check_names(names)
        return [self.get_parameter_type(name) for name in names]

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters below a prefix, by the rest of their names."""
        start = f"{prefix}{PARAMETER_SEPARATOR_STRING}" if prefix else ""
        return {name[len(start) :]: value for name, value in self._parameters.items() if name.startswith(start)}

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        """Return names and prefixes of the parameters below some prefixes, down to a depth (0: all).

        Raises:
            TypeError, ValueError: an argument is malformed.
        """
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")
        separator = PARAMETER_SEPARATOR_STRING

        def is_shallow(name: str) -> bool:
            return depth == DEPTH_RECURSIVE or name.count(separator) < depth

        result = ListParametersResult()
        for name in self._parameters:
            below = [name[len(p) + 1 :] for p in prefixes if name.startswith(f"{p}{separator}")]
            if not (name in prefixes or any(map(is_shallow, below)) or (not prefixes and is_shallow(name))):
                continue
            result.names.append(name)
            prefix = name.rpartition(separator)[0]
            if prefix and prefix not in result.prefixes:
                result.prefixes.append(prefix)
        return result

    def describe_parameter(self, name: str) -> Any:
        """Return a parameter's descriptor; an empty one for an undeclared parameter where those are allowed.

        Raises:
            ParameterNotDeclaredException: it is not declared.
        """
        if name in self._descriptors:
            return self._descriptors[name]
        if self._allow_undeclared_parameters:
            return ParameterDescriptor()
        raise ParameterNotDeclaredException(name)

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """Return several descriptors; raises what describe_parameter raises."""
        return [self.describe_parameter(name) for name in names]


def _check_names(names: list[str]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")
