"""Conditions set by hand, to have an executor call something."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.handle import Handle
from rclpy.utilities import get_default_context
from rclpy_dds.wire import entities


class GuardCondition:
    """Calls its callback in the executor once for one or more triggers."""

    def __init__(
        self, callback: Callable[[], Any] | None, callback_group: CallbackGroup | None, context: Context | None = None
    ) -> None:
        self._context = context or get_default_context()
        self._guard: entities.Guard | None = entities.Guard(self._context.participant.handle)
        self._context._guards.add(self)
        self.callback = callback
        self.callback_group = callback_group
        self._lifetime = Handle(self, self._delete)

    @property
    def handle(self) -> Handle:
        """Return the handle; `with guard.handle:` puts destruction off until the end of the block."""
        return self._lifetime

    @property
    def condition(self) -> int:
        """Return the DDS condition an executor waits for."""
        if self._guard is None:
            raise InvalidHandle("the guard condition was destroyed")
        return self._guard.handle

    def trigger(self) -> None:
        """Have the callback called soon.

        Raises:
            InvalidHandle: it was destroyed.
        """
        if self._guard is None:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        self._guard.set(True)

    def _take(self) -> bool | None:
        if self._guard is None:
            return None
        self._guard.set(False)
        return True

    def _handle(self, taken: Any) -> Any:
        return self.callback() if self.callback is not None else None

    def destroy(self) -> None:
        """Destroy the condition."""
        self._lifetime.destroy_when_not_in_use()

    def _delete(self) -> None:
        if self._guard is not None:
            guard, self._guard = self._guard, None
            guard.delete()
            self._context.changed()
