"""A node's names and arguments: its own name, remapping, parameter overrides."""

from __future__ import annotations

from typing import Any

from rclpy.exceptions import RCLInvalidROSArgsError, UnknownROSArgsError
from rclpy.expand_topic_name import expand_topic_name
from rclpy.parameter import Parameter
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name
from rclpy_dds import arguments as ros_arguments


class NodeNames:
    """Names, mixed into Node."""

    _context: Any
    _name: str
    _namespace: str
    _arguments: list[ros_arguments.Arguments]
    _parameter_overrides: dict[str, Parameter]

    def _read_arguments(self, cli_args: list[str] | None, use_global: bool) -> list[ros_arguments.Arguments]:
        """Return the arguments that count for this node, its own first."""
        found = []
        if cli_args:
            try:
                found.append(ros_arguments.parse(cli_args))
            except ros_arguments.UnknownRosArguments as error:
                raise UnknownROSArgsError(error.args[0]) from None
            except ValueError as error:
                raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {error}") from None
        return [*found, self._context.arguments] if use_global else found

    def _resolve_own_name(self, name: str, namespace: str) -> tuple[str, str]:
        validate_node_name(name)
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        validate_namespace(namespace)
        given = name
        for sources, kind in ((("__node", "__name"), "name"), (("__ns",), "namespace")):
            rule = next(
                (r for a in self._arguments for r in a.remaps if r.source in sources and r.node in ("", given)), None
            )
            if rule is not None and kind == "name":
                name = rule.target
                validate_node_name(name)
            elif rule is not None:
                namespace = rule.target if rule.target.startswith("/") else f"/{rule.target}"
                validate_namespace(namespace)
        self._remap_name = given
        return name, namespace

    def _remap(self, name: str, is_service: bool) -> str:
        other = "rostopic:" if is_service else "rosservice:"
        own = "rosservice:" if is_service else "rostopic:"
        for arguments in self._arguments:
            for rule in arguments.remaps:
                if rule.source.startswith(("__", other)) or rule.node not in ("", self._name, self._remap_name):
                    continue
                source = rule.source.removeprefix(own).removeprefix("//")
                if expand_topic_name(source, self._name, self._namespace) == name:
                    return expand_topic_name(rule.target, self._name, self._namespace)
        return name

    def _read_overrides(self, given: list[Parameter]) -> None:
        full_name = self.get_fully_qualified_name()
        for arguments in reversed(self._arguments):
            for rule in arguments.parameters:
                if ros_arguments.matches(rule.pattern, full_name):
                    self._parameter_overrides[rule.name] = Parameter(rule.name, value=rule.value)
        self._parameter_overrides.update({parameter.name: parameter for parameter in given})

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic's full name, remapped unless only_expand."""
        name = expand_topic_name(topic, self._name, self._namespace)
        return name if only_expand else self._remap(name, is_service=False)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return a service's full name, remapped unless only_expand."""
        name = expand_topic_name(service, self._name, self._namespace)
        return name if only_expand else self._remap(name, is_service=True)

    def _full_name_of(self, name: str, is_service: bool) -> str:
        validate_topic_name(name, is_service=is_service)
        full = self.resolve_service_name(name) if is_service else self.resolve_topic_name(name)
        validate_full_topic_name(full, is_service=is_service)
        return full

    def get_name(self) -> str:
        """Return the name."""
        return self._name

    def get_namespace(self) -> str:
        """Return the namespace."""
        return self._namespace

    def get_fully_qualified_name(self) -> str:
        """Return namespace and name."""
        return f"{self._namespace.rstrip('/')}/{self._name}"
