"""The exceptions of rclpy, raised in the same situations."""

from __future__ import annotations

from typing import Any


class InvalidHandle(RuntimeError):
    """Raised when something destroyed is used."""


class RCLError(RuntimeError):
    """Raised when the middleware refuses an operation."""


class InvalidArgument(RCLError):
    """Raised when an argument has no meaning for the operation."""


class TimerCancelledError(RCLError):
    """Raised when a cancelled timer is asked to fire."""


class NodeNameNonExistentError(RCLError):
    """Raised when a graph query names a node nobody has announced."""


class UnsupportedEventTypeError(RCLError):
    """Raised when the middleware has no such event."""


class RCLInvalidROSArgsError(RCLError):
    """Raised when arguments after --ros-args are malformed."""


class RemapError(RCLError):
    """Raised when a remapping rule cannot be applied."""


class UnknownROSArgsError(RuntimeError):
    """Raised when arguments after --ros-args are not understood."""

    def __init__(self, arguments: list[str]) -> None:
        super().__init__(f"Found unknown ROS arguments: {arguments!r}")
        self.unknown_ros_args = arguments


class NotInitializedException(Exception):
    """Raised when something needs rclpy.init() first."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__("rclpy.init() has not been called." + (f" msg:{message}" if message else ""))


class NoTypeSupportImportedException(Exception):
    """Raised when a message class has no type support."""

    def __init__(self) -> None:
        super().__init__("no type_support imported")


class NameValidationException(Exception):
    """Raised when a topic name, node name or namespace is invalid."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class InvalidNamespaceException(NameValidationException):
    """Raised when a namespace is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """Raised when a node name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """Raised when a topic name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """Raised when a service name is invalid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class ParameterException(Exception):
    """Base of the parameter errors."""

    def __init__(self, error_msg: str, parameters: Any, *args: object) -> None:
        super().__init__(f"{error_msg}: {parameters}", *args)


class ParameterNotDeclaredException(ParameterException):
    """Raised when an undeclared parameter is used where that is not allowed."""

    def __init__(self, parameters: Any, *args: object) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters, *args)


class ParameterAlreadyDeclaredException(ParameterException):
    """Raised when a parameter is declared a second time."""

    def __init__(self, parameters: Any, *args: object) -> None:
        super().__init__("Parameter(s) already declared", parameters, *args)


class InvalidParameterException(ParameterException):
    """Raised when a parameter is declared with an invalid name."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Invalid parameter name", parameter_name)


class InvalidParameterTypeException(ParameterException):
    """Raised when a parameter gets a value of another type than declared."""

    def __init__(self, desired_parameter: Any, expected_type: str) -> None:
        super().__init__(
            f"Trying to set parameter '{desired_parameter.name}' to '{desired_parameter.value}' of type "
            f"'{desired_parameter.type_.name}', expecting type '{expected_type}'",
            desired_parameter.name,
        )


class InvalidParameterValueException(ParameterException):
    """Raised when a value is refused by a callback or a descriptor."""

    def __init__(self, parameter: Any, value: Any, reason: str) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterImmutableException(ParameterException):
    """Raised when a read-only parameter is changed."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)


class ParameterUninitializedException(ParameterException):
    """Raised when a declared parameter without a value is read."""

    def __init__(self, parameter_name: str) -> None:
        Exception.__init__(self, f"The parameter '{parameter_name}' is not initialized")


class ROSInterruptException(Exception):
    """Raised when waiting ends because rclpy was shut down."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")
