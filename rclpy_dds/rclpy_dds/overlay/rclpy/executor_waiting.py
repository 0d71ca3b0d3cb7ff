"""An executor's wait set: kept in step with its nodes' entities, and turned into what is ready."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any

from rclpy.context import Context
from rclpy_dds.wire import entities

_GUARD_KEY, _GRAPH_KEY = 0, 1
# Discovery is taken in this long after it began to change, so that a burst of it does not disturb callbacks often.
_GRAPH_DELAY = 10 * 10**9


class ExecutorWaiting:
    """Waiting, mixed into Executor."""

    _context: Context
    _nodes: dict[Any, None]
    _nodes_lock: threading.RLock
    _ready: deque[Any]

    def _init_waiting(self) -> None:
        participant = self._context.participant.handle
        self._guard = entities.Guard(participant)
        self._waitset = entities.WaitSet(participant)
        self._waitset.attach(self._guard.handle, _GUARD_KEY)
        self._graph_conditions = list(self._context.graph.conditions)
        self._graph_due: int | None = None
        self._attach_graph()
        self._conditions: dict[int, tuple[int, list[Any]]] = {}  # DDS condition -> key, who waits for it
        self._waiting: dict[int, list[Any]] = {}  # key -> who waits
        self._timers: list[Any] = []
        self._blocked: dict[Any, None] = {}
        self._unblock = False
        self._last_key = _GRAPH_KEY
        self._version: Any = None

    def _attach_graph(self) -> None:
        for condition in self._graph_conditions:
            self._waitset.attach(condition, _GRAPH_KEY)

    def _detach_graph(self) -> None:
        for condition in self._graph_conditions:
            self._waitset.detach(condition)
        self._graph_due = time.monotonic_ns() + _GRAPH_DELAY

    def _fold_graph(self) -> None:
        self._graph_due = None
        if self._context._graph is not None:
            self._context._graph.fold()
            self._attach_graph()

    def _wait(self, nanoseconds: int) -> None:
        due = []
        if self._graph_due is not None:
            left = self._graph_due - time.monotonic_ns()
            if left <= 0:
                self._fold_graph()
            else:
                nanoseconds = min(nanoseconds, left)
        for timer in self._timers:
            if timer in self._blocked:
                continue
            remaining = timer._remaining()
            if remaining is not None:
                if remaining <= 0:
                    due.append(timer)
                nanoseconds = min(nanoseconds, max(0, remaining))
        keys = self._waitset.wait(nanoseconds)
        if nanoseconds and not due:
            due = [t for t in self._timers if t not in self._blocked and t._remaining() == 0]
        self._ready.extend(due)
        for key in sorted(keys):
            if key == _GUARD_KEY:
                self._guard.set(False)
            elif key == _GRAPH_KEY:
                self._detach_graph()
            else:
                self._ready.extend(self._waiting.get(key, ()))

    def _refresh(self) -> None:
        """Bring the wait set up to date with the nodes' entities."""
        if self._unblock:
            self._unblock = False
            for entity in list(self._blocked):
                del self._blocked[entity]
                self._attach(entity)
        if self._version == self._context.entities_version:
            return
        with self._nodes_lock:
            self._version = self._context.entities_version
            nodes = list(self._nodes)
        self._timers = [timer for node in nodes for timer in node.timers]
        wanted: dict[int, list[Any]] = {}
        for node in nodes:
            for entity in node._waitable_entities():
                wanted.setdefault(_condition(entity), []).append(entity)
        for handle in [handle for handle in self._conditions if handle not in wanted]:
            key, _ = self._conditions.pop(handle)
            del self._waiting[key]
            self._waitset.detach(handle)
        for handle, owners in wanted.items():
            if handle in self._conditions:
                self._conditions[handle][1][:] = owners
                continue
            self._last_key += 1
            self._waitset.attach(handle, self._last_key)
            self._conditions[handle] = (self._last_key, owners)
            self._waiting[self._last_key] = owners
        for entity in list(self._blocked):
            if entity not in self._timers and _condition(entity) not in wanted:
                del self._blocked[entity]

    def _attach(self, entity: Any) -> None:
        known = self._conditions.get(_condition(entity)) if not hasattr(entity, "_remaining") else None
        if known is not None:
            self._waitset.attach(_condition(entity), known[0])

    def _block(self, entity: Any) -> None:
        """Wait no longer for an entity whose group is busy; what ends there brings it back."""
        self._blocked[entity] = None
        if not hasattr(entity, "_remaining"):
            self._waitset.detach(_condition(entity))
        if entity.callback_group.can_execute(entity):
            self._unblock = True


def _condition(entity: Any) -> int:
    """Return the DDS condition of an entity; an event handler waits for its endpoint's statuses."""
    condition = getattr(entity, "condition", None)
    return entity.entity if condition is None else condition
