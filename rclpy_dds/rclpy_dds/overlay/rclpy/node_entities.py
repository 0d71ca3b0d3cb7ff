"""What a node owns, and how single entities of it are destroyed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.client import Client
from rclpy.context import Context
from rclpy.guard_condition import GuardCondition
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.timer import Rate, Timer


class NodeEntities:
    """Collections of entities, mixed into Node."""

    _context: Context
    _wake_executor: Callable[[], None]

    def _init_entities(self) -> None:
        self._publishers: list[Publisher] = []
        self._subscriptions: list[Subscription] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers: list[Timer] = []
        self._guards: list[GuardCondition] = []
        self._waitables: list[Any] = []

    @property
    def publishers(self) -> Iterator[Publisher]:
        """Yield the publishers."""
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Yield the subscriptions."""
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Client]:
        """Yield the clients."""
        yield from self._clients

    @property
    def services(self) -> Iterator[Service]:
        """Yield the services."""
        yield from self._services

    @property
    def timers(self) -> Iterator[Timer]:
        """Yield the timers."""
        yield from self._timers

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """Yield the guard conditions."""
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Any]:
        """Yield the event handlers and what else an executor waits for."""
        yield from self._waitables

    def _waitable_entities(self) -> Iterator[Any]:
        """Yield everything with a DDS condition, in the order callbacks are run."""
        yield from self._subscriptions
        yield from self._guards
        yield from self._clients
        yield from self._services
        yield from self._waitables

    def _added(self, collection: list[Any], entity: Any) -> Any:
        collection.append(entity)
        if getattr(entity, "callback_group", None) is not None:
            entity.callback_group.add_entity(entity)
        self._context.changed()
        self._wake_executor()
        return entity

    def _destroy(self, collection: list[Any], entity: Any) -> bool:
        if entity not in collection:
            return False
        collection.remove(entity)
        for handler in getattr(entity, "event_handlers", ()):
            if handler in self._waitables:
                self._waitables.remove(handler)
        entity.destroy()
        self._wake_executor()
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroy a publisher; False when it is not this node's."""
        return self._destroy(self._publishers, publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroy a subscription; False when it is not this node's."""
        return self._destroy(self._subscriptions, subscription)

    def destroy_client(self, client: Client) -> bool:
        """Destroy a client; False when it is not this node's."""
        return self._destroy(self._clients, client)

    def destroy_service(self, service: Service) -> bool:
        """Destroy a service; False when it is not this node's."""
        return self._destroy(self._services, service)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroy a timer; False when it is not this node's."""
        return self._destroy(self._timers, timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroy a guard condition; False when it is not this node's."""
        return self._destroy(self._guards, guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate; False when it is not this node's."""
        destroyed = self.destroy_timer(rate._timer)
        rate.destroy()
        return destroyed
