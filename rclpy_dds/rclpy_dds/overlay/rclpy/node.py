"""The node: makes and owns publishers, subscriptions, services, clients, timers."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent

from rclpy import rosout
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock, ROSClock
from rclpy.constants import S_TO_NS
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import NotInitializedException
from rclpy.executors import Executor
from rclpy.guard_condition import GuardCondition
from rclpy.handle import Handle
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.logging import get_logger
from rclpy.logging_service import LoggingService
from rclpy.node_entities import NodeEntities
from rclpy.node_graph import NodeGraph
from rclpy.node_names import NodeNames
from rclpy.node_parameters import NodeParameters
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_rosout_default, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions, _declare_qos_parameters
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.time_source import TimeSource
from rclpy.timer import Rate, Timer
from rclpy.type_description_service import TypeDescriptionService
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from rclpy.utilities import get_default_context


class Node(NodeNames, NodeEntities, NodeParameters, NodeGraph):
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

    # Making

    @staticmethod
    def _validate_qos(qos_or_depth: QoSProfile | int) -> QoSProfile:
        if isinstance(qos_or_depth, QoSProfile):
            return qos_or_depth
        if not isinstance(qos_or_depth, int):
            raise TypeError("Expected QoSProfile or int, but received " + repr(type(qos_or_depth)))
        if qos_or_depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos_or_depth)

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Publisher:
        """Make a publisher.

        Args:
            msg_type: the message class.
            topic: the name, relative to the namespace, absolute, or private with ~.
            qos_profile: a profile or the depth of the history.
            callback_group, event_callbacks: for events about quality of service.
            qos_overriding_options: which policies parameters may override.
            publisher_class: a subclass to make.
        """
        profile = self._validate_qos(qos_profile)
        check_is_valid_msg_type(msg_type)
        full = self._full_name_of(topic, is_service=False)
        if qos_overriding_options is not None:
            profile = _declare_qos_parameters("publisher", self, full, profile, qos_overriding_options)
        publisher = publisher_class(self, msg_type, full, profile)
        handlers = (event_callbacks or PublisherEventCallbacks()).create_event_handlers(
            callback_group or self.default_callback_group, publisher, publisher._entity, topic, self._logger_name
        )
        return self._own_endpoint(self._publishers, publisher, handlers)

    def _own_endpoint(self, collection: list[Any], endpoint: Any, handlers: list[Any]) -> Any:
        endpoint.event_handlers = handlers
        for handler in handlers:
            self._added(self._waitables, handler)
        return self._added(collection, endpoint)

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription:
        """Make a subscription.

        Args:
            msg_type: the message class.
            topic: the name, relative to the namespace, absolute, or private with ~.
            callback: takes the message, or the message and its info.
            qos_profile: a profile or the depth of the history.
            callback_group: when the callback may run; the node's default group when None.
            event_callbacks: for events about quality of service.
            qos_overriding_options: which policies parameters may override.
            raw: hand out CDR bytes with their encapsulation header, not messages.
        """
        profile = self._validate_qos(qos_profile)
        check_is_valid_msg_type(msg_type)
        full = self._full_name_of(topic, is_service=False)
        if qos_overriding_options is not None:
            profile = _declare_qos_parameters("subscription", self, full, profile, qos_overriding_options)
        group = callback_group or self.default_callback_group
        subscription = Subscription(self, msg_type, full, callback, group, profile, raw)
        handlers = (event_callbacks or SubscriptionEventCallbacks()).create_event_handlers(
            group, subscription, subscription._entity, topic, self._logger_name
        )
        return self._own_endpoint(self._subscriptions, subscription, handlers)

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Make a client of a service."""
        check_is_valid_srv_type(srv_type)
        full = self._full_name_of(srv_name, is_service=True)
        client = Client(self, srv_type, full, qos_profile, callback_group or self.default_callback_group)
        return self._added(self._clients, client)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[..., Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Offer a service; the callback takes request and response and returns the response."""
        check_is_valid_srv_type(srv_type)
        full = self._full_name_of(srv_name, is_service=True)
        service = Service(self, srv_type, full, callback, callback_group or self.default_callback_group, qos_profile)
        return self._added(self._services, service)

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Call a function every `timer_period_sec` seconds of a clock, by default the node's."""
        timer = Timer(
            callback,
            callback_group or self.default_callback_group,
            int(float(timer_period_sec) * S_TO_NS),
            clock or self._clock,
            context=self._context,
            autostart=autostart,
            wake=self._wake_executor,
        )
        return self._added(self._timers, timer)

    def create_guard_condition(
        self, callback: Callable[[], Any], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Make a condition that has the executor call a function when triggered."""
        guard = GuardCondition(callback, callback_group or self.default_callback_group, self._context)
        return self._added(self._guards, guard)

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Make a rate to sleep to, in Hz.

        Raises:
            ValueError: the frequency is not positive.
        """
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        return Rate(timer, context=self._context)

    def add_waitable(self, waitable: Any) -> None:
        """Not offered: rclpy's waitables work on rcl's wait sets."""
        raise NotImplementedError("rclpy_dds has no custom waitables; use a real ROS 2 for them (https://docs.ros.org)")

    # Destroying

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
