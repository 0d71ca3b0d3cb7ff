"""The node: its life and what belongs to it; what it makes, owns and knows is in its bases."""

from __future__ import annotations

import weakref
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent

from rclpy import rosout
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ROSClock
from rclpy.context import Context
from rclpy.exceptions import NotInitializedException
from rclpy.executors import Executor
from rclpy.handle import Handle
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.logging_service import LoggingService
from rclpy.node_graph import NodeGraph
from rclpy.node_making import NodeMaking
from rclpy.node_names import NodeNames
from rclpy.node_parameters import NodeParameters
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_rosout_default
from rclpy.time_source import TimeSource
from rclpy.type_description_service import TypeDescriptionService
from rclpy.utilities import get_default_context


class Node(NodeNames, NodeMaking, NodeParameters, NodeGraph):
    """A participant in the ROS graph under one name."""

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        rosout_qos_profile: QoSProfile | int = qos_profile_rosout_default,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        """Make a node; the arguments mean what they mean in rclpy.

        Raises:
            NotInitializedException: rclpy.init() has not been called, or shutdown has.
            InvalidNodeNameException, InvalidNamespaceException: a name is invalid.
        """
        self._context = context or get_default_context()
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        self._arguments = self._read_arguments(cli_args, use_global_arguments)
        self._name, self._namespace = self._resolve_own_name(node_name, namespace or "")
        self._init_entities()
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self._executor_weakref: weakref.ReferenceType[Executor] | None = None
        self._lifetime = Handle(self, self._delete)
        self._graph_entry = self._context.graph.add_node(self._name, self._namespace)
        self._logger_name = self.get_fully_qualified_name().strip("/").replace("/", ".")
        self._logger = get_logger(self._logger_name)
        self._clock = ROSClock()
        self._init_parameters(allow_undeclared_parameters)
        self._rosout_publisher: rosout.RosoutPublisher | None = None
        if enable_rosout and self._context.arguments.rosout:
            self._rosout_publisher = rosout.start(self, self._logger_name, self._validate_qos(rosout_qos_profile))
        self._parameter_event_publisher = self.create_publisher(
            ParameterEvent, "/parameter_events", qos_profile_parameter_events
        )
        self._read_overrides(parameter_overrides or [])
        if automatically_declare_parameters_from_overrides:
            found = [(name, p.value, ParameterDescriptor()) for name, p in self._parameter_overrides.items()]
            self.declare_parameters("", found, ignore_override=True)
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    # What belongs to the node

    @property
    def context(self) -> Context:
        """Return the context."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """Return the group callbacks are in when none is given."""
        return self._default_callback_group

    @property
    def handle(self) -> Handle:
        """Return the handle; `with node.handle:` puts destruction off until the end of the block."""
        return self._lifetime

    @handle.setter
    def handle(self, value: object) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def get_clock(self) -> Clock:
        """Return the node's clock, which follows /clock when use_sim_time is set."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the node's logger."""
        return self._logger

    @property
    def executor(self) -> Executor | None:
        """Return the executor that serves the node, None when there is none."""
        return self._executor_weakref() if self._executor_weakref is not None else None

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current is new_executor:
            return
        if current is not None:
            current.remove_node(self)
        if new_executor is None:
            self._executor_weakref = None
            return
        self._executor_weakref = weakref.ref(new_executor)
        new_executor.add_node(self)

    def _forget_executor(self) -> None:
        self._executor_weakref = None

    def _wake_executor(self) -> None:
        executor = self.executor
        if executor is not None:
            executor.wake()

    # Destroying, and what is not offered

    def add_waitable(self, waitable: Any) -> None:
        """Not offered: rclpy's waitables work on rcl's wait sets."""
        raise NotImplementedError("rclpy_dds has no custom waitables; use a real ROS 2 for them (https://docs.ros.org)")

    def destroy_node(self) -> None:
        """Destroy everything the node owns and take it off the graph."""
        executor = self.executor
        if executor is not None:
            executor.remove_node(self)
        self._lifetime.destroy_when_not_in_use()

    def _delete(self) -> None:
        for collection in (
            self._publishers,
            self._subscriptions,
            self._clients,
            self._services,
            self._timers,
            self._guards,
        ):
            for entity in list(collection):
                self._destroy(collection, entity)
        self._waitables.clear()
        if self._rosout_publisher is not None:
            rosout.stop(self._rosout_publisher, self._logger_name)
        if self._context._graph is not None:
            self._context._graph.remove_node(self._graph_entry)

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy_node()
