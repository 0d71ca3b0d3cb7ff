"""A node's parameters: setting and describing; declaring and reading are beside this."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import (
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)

from rclpy.exceptions import (
    InvalidParameterValueException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.node_parameter_declaration import NodeParameterDeclaration
from rclpy.node_parameter_reading import NodeParameterReading
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_ranges import float_problem, integer_problem

_OK = {"successful": True, "reason": ""}


class NodeParameters(NodeParameterDeclaration, NodeParameterReading):
    """Parameters, mixed into Node."""

    PARAM_REL_TOL = 1e-6
    _parameter_event_publisher: Any = None

    def _init_parameters(self, allow_undeclared: bool) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._parameter_overrides: dict[str, Parameter] = {}
        self._allow_undeclared_parameters = allow_undeclared
        self._pre_set_parameters_callbacks: list[Callable[[list[Parameter]], list[Parameter]]] = []
        self._on_set_parameters_callbacks: list[Callable[[list[Parameter]], Any]] = []
        self._post_set_parameters_callbacks: list[Callable[[list[Parameter]], None]] = []

    # Setting

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Set parameters one by one and return a result for each.

        Raises:
            ParameterNotDeclaredException: one is not declared and may not be left so; those before it are set.
        """
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Set all parameters or none and return the result.

        Raises:
            ParameterNotDeclaredException: one is not declared and may not be left so.
        """
        self._check_undeclared(parameter_list)
        return self._set_with_pre_callbacks(parameter_list)

    def _set_with_pre_callbacks(self, parameter_list: list[Parameter]) -> Any:
        modified = parameter_list
        for callback in self._pre_set_parameters_callbacks:
            modified = callback(modified)
        if self._pre_set_parameters_callbacks:
            if not modified:
                return SetParametersResult(
                    successful=False,
                    reason="parameter list cannot be empty, this might be due to pre_set_parameters_callback"
                    " modifying the original parameters list.",
                )
            self._check_undeclared(modified)
        return self._set_atomically(modified)

    def _check_undeclared(self, parameter_list: list[Parameter]) -> None:
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError("parameter must be instance of type 'rclpy.parameter.Parameter'")
        undeclared = [parameter.name for parameter in parameter_list if parameter.name not in self._parameters]
        if undeclared and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(undeclared)

    def _set_atomically(
        self,
        parameter_list: list[Parameter],
        descriptors: dict[str, Any] | None = None,
        allow_not_set_type: bool = False,
    ) -> Any:
        if descriptors is not None:
            result = self._apply_descriptors(parameter_list, descriptors, False)
        else:
            implicit = [p for p in parameter_list if p.name not in self._descriptors]
            for parameter in implicit:
                self._descriptors[parameter.name] = ParameterDescriptor(name=parameter.name, dynamic_typing=True)
            result = self._apply_descriptors(parameter_list, self._descriptors, True)
            if not result.successful:
                for parameter in implicit:
                    del self._descriptors[parameter.name]
        if not result.successful:
            return result
        for callback in self._on_set_parameters_callbacks:
            result = callback(parameter_list)
            if not result.successful:
                if descriptors is None:
                    for parameter in implicit:
                        del self._descriptors[parameter.name]
                return result
        event = self._store(parameter_list, descriptors, allow_not_set_type)
        for post_callback in self._post_set_parameters_callbacks:
            post_callback(parameter_list)
        event.stamp = self._clock.now().to_msg()
        self._parameter_event_publisher.publish(event)
        return SetParametersResult(**_OK)

    def _store(
        self, parameter_list: list[Parameter], descriptors: dict[str, Any] | None, allow_not_set_type: bool
    ) -> Any:
        event = ParameterEvent(node=self.get_fully_qualified_name())
        for parameter in parameter_list:
            name = parameter.name
            known = name in self._parameters
            if descriptors is not None:
                self._descriptors[name] = descriptors[name]
            if parameter.type_ is Parameter.Type.NOT_SET and not allow_not_set_type:
                if known:
                    event.deleted_parameters.append(Parameter(name, Parameter.Type.NOT_SET).to_parameter_msg())
                    del self._parameters[name]
                self._descriptors.pop(name, None)
                continue
            unset = not known or self._parameters[name].type_ is Parameter.Type.NOT_SET
            (event.new_parameters if unset else event.changed_parameters).append(parameter.to_parameter_msg())
            self._parameters[name] = parameter
        return event

    def _apply_descriptors(
        self, parameter_list: list[Parameter], descriptors: dict[str, Any], check_read_only: bool
    ) -> Any:
        for parameter in parameter_list:
            if parameter.name in descriptors:
                result = self._apply_descriptor(parameter, descriptors[parameter.name], check_read_only)
                if not result.successful:
                    return result
        return SetParametersResult(**_OK)

    def _apply_descriptor(self, parameter: Parameter, descriptor: Any, check_read_only: bool) -> Any:
        descriptor.name = parameter.name
        reason, kind = "", parameter.type_
        if check_read_only and descriptor.read_only:
            reason = f"Trying to set a read-only parameter: {parameter.name}."
        elif descriptor.dynamic_typing:
            descriptor.type = kind.value
        elif kind is Parameter.Type.NOT_SET and parameter.name in self._parameters:
            reason = "Static parameter cannot be undeclared"
        elif kind is not Parameter.Type.NOT_SET and kind.value != descriptor.type:
            reason = f"Wrong parameter type, expected '{Parameter.Type(descriptor.type)}' got '{kind}'"
        if not reason and kind is Parameter.Type.INTEGER and descriptor.integer_range:
            reason = integer_problem(parameter, descriptor.integer_range[0])
        if not reason and kind is Parameter.Type.DOUBLE and descriptor.floating_point_range:
            reason = float_problem(parameter, descriptor.floating_point_range[0], self.PARAM_REL_TOL)
        return SetParametersResult(successful=not reason, reason=reason)

    # Callbacks

    def add_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        """Have a function change the list before it is checked; the newest runs first."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], Any]) -> None:
        """Have a function accept or refuse values; the newest runs first."""
        self._on_set_parameters_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        """Have a function called after values were set; the newest runs first."""
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        """Remove such a function; ValueError when it is not there."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], Any]) -> None:
        """Remove such a function; ValueError when it is not there."""
        self._on_set_parameters_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        """Remove such a function; ValueError when it is not there."""
        self._post_set_parameters_callbacks.remove(callback)

    # Describing

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Replace a parameter's descriptor, and its value where one is given; returns the value.

        Raises:
            ParameterNotDeclaredException, ParameterImmutableException, ParameterAlreadyDeclaredException,
            InvalidParameterValueException: as their names say.
        """
        if name not in self._parameters:
            if self._allow_undeclared_parameters:
                return self.get_parameter(name).get_parameter_value()
            raise ParameterNotDeclaredException(name)
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        current = self.get_parameter(name)
        wanted = current
        if alternative_value is not None:
            wanted = Parameter(
                name, Parameter.Type(alternative_value.type), parameter_value_to_python(alternative_value)
            )
        if not descriptor.dynamic_typing:
            descriptor.type = wanted.type_.value
        result = self._apply_descriptor(wanted, descriptor, check_read_only=False)
        if not result.successful:
            raise InvalidParameterValueException(name, wanted.value, result.reason)
        self._descriptors[name] = descriptor
        self._parameters[name] = wanted
        return wanted.get_parameter_value()
