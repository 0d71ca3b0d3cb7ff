"""Executors: wait for what is ready and run its callbacks."""

from __future__ import annotations

import inspect
import os
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Future as PoolFuture
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType
from typing import Any

from rclpy.context import Context
from rclpy.executor_waiting import ExecutorWaiting
from rclpy.executor_work import ExecutorWork
from rclpy.task import Future, Task
from rclpy.utilities import get_default_context
from rclpy_dds.wire import entities


class TimeoutException(Exception):
    """Signal that nothing became ready in time."""


class ShutdownException(Exception):
    """Signal that the executor was shut down."""


class ExternalShutdownException(Exception):
    """Raised when the context was shut down while an executor was at work."""

    def __init__(self, *args: object) -> None:
        super().__init__(*(args or ("The context was shut down from outside the executor",)))


class ConditionReachedException(Exception):
    """Signal that what was waited for has happened."""


class TimeoutObject:
    """A time limit counted down over several waits."""

    def __init__(self, timeout_sec: float | None) -> None:
        self._end = None if timeout_sec is None or timeout_sec < 0 else time.monotonic_ns() + int(timeout_sec * 1e9)

    def remaining(self) -> int:
        """Return the nanoseconds that are left."""
        return entities.INFINITY if self._end is None else max(0, self._end - time.monotonic_ns())


async def await_or_execute(callback: Any, *args: Any) -> Any:
    """Call a function, or await a coroutine function, and return its result."""
    return await callback(*args) if inspect.iscoroutinefunction(callback) else callback(*args)


class Executor(ExecutorWaiting, ExecutorWork):
    """Base of the executors: collects what nodes wait for and hands out work."""

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = context or get_default_context()
        self._nodes: dict[Any, None] = {}
        self._nodes_lock = threading.RLock()
        self._wait_lock = threading.RLock()
        self._init_waiting()
        self._init_work()
        self._is_shutdown = False
        self._context._guards.add(self)
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        """Return the context whose nodes this executor serves."""
        return self._context

    @property
    def is_shutdown(self) -> bool:
        """Tell whether shutdown was called."""
        return self._is_shutdown

    def trigger(self) -> None:
        """End a wait in progress."""
        self._guard.set(True)

    wake = trigger

    def create_task(self, callback: Any, *args: Any, **kwargs: Any) -> Task:
        """Have a function or coroutine run by this executor and return its task."""
        task = Task(callback, args, kwargs, executor=self)
        self._queue(task)
        return task

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop; False when callbacks were still running after the time given."""
        self._is_shutdown = True
        self.wake()
        with self._idle:
            if not self._idle.wait_for(lambda: self._working == 0, timeout_sec):
                return False
        with self._nodes_lock:
            for node in list(self._nodes):
                self.remove_node(node)
        with self._wait_lock:
            self._waitset.delete()
            self._guard.delete()
        self._context._guards.discard(self)
        self._context._forget_on_shutdown(self.wake)
        return True

    def __del__(self) -> None:
        waitset = getattr(self, "_waitset", None)
        if waitset is not None and not self._is_shutdown:
            waitset.delete()
            self._guard.delete()

    def add_node(self, node: Any) -> bool:
        """Serve a node; False when it is served already."""
        with self._nodes_lock:
            if node in self._nodes:
                return False
            self._nodes[node] = None
            node.executor = self
            self._version = None
        self.wake()
        return True

    def remove_node(self, node: Any) -> None:
        """Serve a node no longer."""
        with self._nodes_lock:
            if self._nodes.pop(node, self) is None:
                self._version = None
                if node.executor is self:
                    node._forget_executor()
                self.wake()

    def get_nodes(self) -> list[Any]:
        """Return the nodes that are served."""
        with self._nodes_lock:
            return list(self._nodes)

    # Spinning

    def spin(self) -> None:
        """Run callbacks until shutdown."""
        while self._context.ok() and not self._is_shutdown:
            self.spin_once()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done or the time is up."""
        self._wake_when_done(future)
        limit = TimeoutObject(timeout_sec)
        while self._context.ok() and not self._is_shutdown and not (future.done() or future.cancelled()):
            remaining = limit.remaining()
            self._spin_once(None if remaining == entities.INFINITY else remaining / 1e9, future.done)
            if remaining == 0:
                return

    def _wake_when_done(self, future: Future) -> None:
        def wake(_: Future) -> None:
            self.wake()

        wake._immediate = True  # type: ignore[attr-defined]
        future.add_done_callback(wake)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback, at most the time given, and run it.

        Raises:
            ExternalShutdownException: the context was shut down.
        """
        self._spin_once(timeout_sec, None)

    def spin_once_until_future_complete(self, future: Future, timeout_sec: float | TimeoutObject | None = None) -> None:
        """Wait for one callback or a future, at most the time given, and run the callback."""
        self._wake_when_done(future)
        self._spin_once(timeout_sec, future.done)

    def _spin_once(self, timeout_sec: Any, condition: Callable[[], bool] | None) -> None:
        try:
            work, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, condition)
        except (TimeoutException, ShutdownException, ConditionReachedException):
            return
        work()

    # Finding work

    def _wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Iterator[tuple[Callable[[], None], Any, Any]]:
        while True:
            yield self.wait_for_ready_callbacks(*args, **kwargs)

    def wait_for_ready_callbacks(
        self, timeout_sec: Any = None, nodes: Any = None, condition: Callable[[], bool] | None = None
    ) -> tuple[Callable[[], None], Any, Any]:
        """Wait for work and return (function that does it, entity or task, None).

        Raises:
            TimeoutException, ShutdownException, ConditionReachedException: there is none, and why.
            ExternalShutdownException: the context was shut down.
        """
        limit = timeout_sec if isinstance(timeout_sec, TimeoutObject) else TimeoutObject(timeout_sec)
        with self._wait_lock:
            waited = False
            while True:
                if self._is_shutdown:
                    raise ShutdownException()
                if not self._context.ok():
                    raise ExternalShutdownException()
                if condition is not None and condition():
                    raise ConditionReachedException()
                work = self._ready_work()
                if work is not None:
                    return work, work.args[0], None
                remaining = limit.remaining()
                if waited and remaining == 0:
                    raise TimeoutException()
                self._refresh()
                self._wait(remaining)
                waited = True

    def __enter__(self) -> Executor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.shutdown()


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins."""


class MultiThreadedExecutor(Executor):
    """Runs callbacks in a pool of threads."""

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        if num_threads is None:
            affinity = getattr(os, "sched_getaffinity", None)
            num_threads = max(len(affinity(0)) if affinity else os.cpu_count() or 2, 2)
        if num_threads == 1:
            warnings.warn(
                "MultiThreadedExecutor is used with a single thread.\nUse the SingleThreadedExecutor instead.",
                stacklevel=2,
            )
        self._executor = ThreadPoolExecutor(num_threads)
        self._futures: list[PoolFuture[None]] = []

    def _spin_once(self, timeout_sec: Any, condition: Callable[[], bool] | None) -> None:
        try:
            work, _, _ = self.wait_for_ready_callbacks(
                timeout_sec, None, lambda: self._has_failed() or (condition is not None and condition())
            )
        except (TimeoutException, ShutdownException, ConditionReachedException):
            self._raise_errors()
            return
        future = self._executor.submit(work)
        self._futures.append(future)
        future.add_done_callback(lambda _: self.wake())
        self._raise_errors()

    def _has_failed(self) -> bool:
        return any(future.done() and future.exception() is not None for future in self._futures)

    def _raise_errors(self) -> None:
        done = [future for future in self._futures if future.done()]
        self._futures = [future for future in self._futures if future not in done]
        for future in done:
            future.result()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop; False when callbacks were still running after the time given."""
        finished = super().shutdown(timeout_sec)
        self._executor.shutdown(wait=False)
        return finished
