"""An executor's work: which of what is ready may run, running it, and going on with coroutines."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from functools import partial
from types import CoroutineType
from typing import Any

from rclpy.exceptions import InvalidHandle
from rclpy.task import Future, Task


class ExecutorWork:
    """Claiming and doing work, mixed into Executor."""

    wake: Callable[..., None]
    _block: Callable[[Any], None]
    _blocked: dict[Any, None]
    _unblock: bool

    def _init_work(self) -> None:
        self._ready: deque[Any] = deque()
        self._tasks: deque[Task] = deque()
        self._idle = threading.Condition()
        self._working = 0

    def _queue(self, task: Task) -> None:
        self._tasks.append(task)
        self.wake()

    def _ready_work(self) -> partial[None] | None:
        while self._ready:
            work = self._claim(self._ready.popleft())
            if work is not None:
                return work
        while self._tasks:
            task = self._tasks.pop()  # the newest first, as rclpy does
            if not task.done() and not task.cancelled():
                self._working_started()
                return partial(self._run_task, task)
        return None

    def _claim(self, entity: Any) -> partial[None] | None:
        group = entity.callback_group
        if group is not None and not group.beginning_execution(entity):
            if entity not in self._blocked:
                self._block(entity)
            return None
        self._working_started()
        try:
            taken = entity._take()
        except InvalidHandle:
            taken = None
        except BaseException:
            self._release(entity)
            self._working_ended()
            raise
        if taken is None:
            self._release(entity)
            self._working_ended()
            return None
        return partial(self._run, entity, taken)

    def _working_started(self) -> None:
        with self._idle:
            self._working += 1

    def _release(self, entity: Any) -> None:
        if entity.callback_group is not None:
            entity.callback_group.ending_execution(entity)
        if self._blocked:
            self._unblock = True
            self.wake()

    def _working_ended(self) -> None:
        with self._idle:
            self._working -= 1
            if self._working == 0:
                self._idle.notify_all()

    def _run(self, entity: Any, taken: Any) -> None:
        finished = True
        try:
            result = entity._handle(taken)
            if type(result) is CoroutineType:
                finished = False
                self._begin_coroutine(entity, result)
        finally:
            if finished:
                self._release(entity)
            self._working_ended()

    def _begin_coroutine(self, entity: Any, coroutine: Any) -> None:
        task = Task(coroutine, executor=self)

        def release(_: Future) -> None:
            self._release(entity)

        release._immediate = True  # type: ignore[attr-defined]
        task.add_done_callback(release)
        self._working_started()
        self._run_task(task)

    def _run_task(self, task: Task) -> None:
        try:
            task()
            if task.done():
                error = task.exception()
                if error is not None:
                    raise error
            elif not task.cancelled():
                self._requeue(task)
        finally:
            self._working_ended()

    def _requeue(self, task: Task) -> None:
        if task.awaited is None:  # it yielded without waiting for anything: others go first
            self._tasks.appendleft(task)
            self.wake()
            return

        def resume(_: Future) -> None:
            self._queue(task)

        resume._immediate = True  # type: ignore[attr-defined]
        task.awaited.add_done_callback(resume)
