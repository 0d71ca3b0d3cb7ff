"""Handles: what is destroyed while somebody uses it goes when the last use ends."""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any

from rclpy.exceptions import InvalidHandle


class Handle:
    """Guards the life of one entity; `with entity.handle:` keeps it for that long."""

    def __init__(self, owner: Any, delete: Callable[[], None]) -> None:
        self._owner = owner
        self._delete = delete
        self._lock = threading.Lock()
        self._uses = 0
        self.destroyed = False

    def __enter__(self) -> Handle:
        with self._lock:
            if self.destroyed:
                raise InvalidHandle("cannot use Destroyable because destruction was requested")
            self._uses += 1
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        with self._lock:
            self._uses -= 1
            last = self.destroyed and self._uses == 0
        if last:
            self._delete()

    def destroy_when_not_in_use(self) -> None:
        """Delete the entity now, or when the last use ends."""
        with self._lock:
            if self.destroyed:
                return
            self.destroyed = True
            now = self._uses == 0
        if now:
            self._delete()

    def __getattr__(self, name: str) -> Any:
        """Offer the entity's own methods, some of which rclpy has on the handle."""
        return getattr(self._owner, name)
