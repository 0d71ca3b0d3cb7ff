"""Parameters of another node, through its services."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.subscription import Subscription
from rclpy.task import Future

_POLL = 0.02


class AsyncParameterClient:
    """Calls the parameter services of one node; every call returns the future of the reply."""

    def __init__(
        self,
        node: Node,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.remote_node_name = remote_node_name
        self.node = node
        self._clients = {
            srv_type: node.create_client(
                srv_type, f"{remote_node_name}/{name}", qos_profile=qos_profile, callback_group=callback_group
            )
            for srv_type, name in (
                (GetParameters, "get_parameters"),
                (ListParameters, "list_parameters"),
                (SetParameters, "set_parameters"),
                (GetParameterTypes, "get_parameter_types"),
                (DescribeParameters, "describe_parameters"),
                (SetParametersAtomically, "set_parameters_atomically"),
            )
        }

    def services_are_ready(self) -> bool:
        """Tell whether all six services are there."""
        return all(client.service_is_ready() for client in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait until all six services are there; False when the time ran out."""
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        while not self.services_are_ready():
            if end is not None and time.monotonic() >= end:
                return False
            time.sleep(_POLL)
        return True

    def _call(self, srv_type: Any, callback: Callable[[Future], None] | None, **fields: Any) -> Future:
        future = self._clients[srv_type].call_async(srv_type.Request(**fields))
        if callback is not None:
            future.add_done_callback(callback)
        return future

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: Callable[[Future], None] | None = None,
    ) -> Future:
        """List the parameters below some prefixes, down to a depth."""
        return self._call(ListParameters, callback, prefixes=prefixes or [], depth=depth or 0)

    def get_parameters(self, names: list[str], callback: Callable[[Future], None] | None = None) -> Future:
        """Get values."""
        return self._call(GetParameters, callback, names=names)

    def set_parameters(self, parameters: Sequence[Any], callback: Callable[[Future], None] | None = None) -> Future:
        """Set parameters one by one."""
        return self._call(SetParameters, callback, parameters=_messages(parameters))

    def describe_parameters(self, names: list[str], callback: Callable[[Future], None] | None = None) -> Future:
        """Get descriptors."""
        return self._call(DescribeParameters, callback, names=names)

    def get_parameter_types(self, names: list[str], callback: Callable[[Future], None] | None = None) -> Future:
        """Get types."""
        return self._call(GetParameterTypes, callback, names=names)

    def set_parameters_atomically(
        self, parameters: Sequence[Any], callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Set all parameters or none."""
        return self._call(SetParametersAtomically, callback, parameters=_messages(parameters))

    def delete_parameters(self, names: list[str], callback: Callable[[Future], None] | None = None) -> Future:
        """Unset parameters; only dynamically typed ones allow it."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def load_parameter_file(
        self, parameter_file: str, use_wildcard: bool = False, callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Set parameters from a YAML file one by one."""
        return self.set_parameters(list(parameter_dict_from_yaml_file(parameter_file, use_wildcard).values()), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: Callable[[Future], None] | None = None
    ) -> Future:
        """Set all parameters of a YAML file or none."""
        found = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(found.values()), callback)

    def on_parameter_event(
        self, callback: Callable[[Any], None], qos_profile: QoSProfile = qos_profile_parameter_events, **options: Any
    ) -> Subscription:
        """Have a function called with every parameter event; the options are those of create_subscription."""
        return self.node.create_subscription(ParameterEvent, "/parameter_events", callback, qos_profile, **options)


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [p.to_parameter_msg() if isinstance(p, Parameter) else p for p in parameters]
