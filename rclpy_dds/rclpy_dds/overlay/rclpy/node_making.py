"""What a node makes: publishers, subscriptions, services, clients, timers, guard conditions, rates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock
from rclpy.constants import S_TO_NS
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.guard_condition import GuardCondition
from rclpy.node_entities import NodeEntities
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions, _declare_qos_parameters
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Rate, Timer
from rclpy.type_support import check_is_valid_msg_type, check_is_valid_srv_type


class NodeMaking(NodeEntities):
    """Making, mixed into Node."""

    _clock: Clock
    _logger_name: str
    _rate_group: CallbackGroup
    _full_name_of: Callable[..., str]
    default_callback_group: Any

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
