"""Waiting for one message."""

from __future__ import annotations

import time
from typing import Any

from rclpy.qos import QoSProfile
from rclpy_dds.wire import entities


def wait_for_message(
    msg_type: Any, node: Any, topic: str, *, qos_profile: QoSProfile | int = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """Wait for the next message of a topic.

    Returns:
        (True, message), or (False, None) when the time (s, negative: for ever) ran out or rclpy was shut down.
    """
    context = node.context
    guard, waitset = entities.Guard(context.participant.handle), entities.WaitSet(context.participant.handle)
    wake = _Wake(guard)
    context.on_shutdown(wake.trigger)
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile)
    try:
        waitset.attach(guard.handle, 0)
        waitset.attach(subscription.condition, 1)
        end = None if time_to_wait < 0 else time.monotonic_ns() + int(time_to_wait * 1e9)
        while context.ok():
            taken = subscription._take()
            if taken is not None:
                return True, taken[0]
            remaining = entities.INFINITY if end is None else end - time.monotonic_ns()
            if remaining <= 0:
                break
            waitset.wait(remaining)
        return False, None
    finally:
        context._forget_on_shutdown(wake.trigger)
        waitset.delete()
        guard.delete()
        node.destroy_subscription(subscription)


class _Wake:
    """Ends the wait at shutdown."""

    def __init__(self, guard: entities.Guard) -> None:
        self._guard = guard

    def trigger(self) -> None:
        self._guard.set(True)
