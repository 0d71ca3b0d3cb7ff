"""Futures, and tasks that run functions and coroutines for an executor."""

from __future__ import annotations

import inspect
import sys
import threading
import warnings
import weakref
from collections.abc import Callable, Coroutine, Generator
from types import CoroutineType
from typing import Any


class Future:
    """A result that is not there yet."""

    def __init__(self, *, executor: Any = None) -> None:
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None
        self._exception_fetched = False
        self._callbacks: list[Callable[[Any], Any]] = []
        self._lock = threading.Lock()
        self._executor: Any = None
        self._set_executor(executor)

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            print(f"The following exception was never retrieved: {self._exception}", file=sys.stderr)

    def __await__(self) -> Generator[Any, None, Any]:
        while not self._done and not self._cancelled:
            yield self
        return self.result()

    def cancel(self) -> None:
        """Cancel; a future that is done stays as it is."""
        with self._lock:
            if not self._done:
                self._cancelled = True
        self._run_callbacks()

    def cancelled(self) -> bool:
        """Tell whether it was cancelled."""
        return self._cancelled

    def done(self) -> bool:
        """Tell whether there is a result or an exception."""
        return self._done

    def result(self) -> Any:
        """Return the result; raise the exception if there is one."""
        if self._exception is not None:
            raise self.exception()  # type: ignore[misc]
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception, None when there is none."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        """Set the result and run the callbacks."""
        with self._lock:
            self._result = result
            self._done = True
            self._cancelled = False
        self._run_callbacks()

    def set_exception(self, exception: BaseException) -> None:
        """Set the exception and run the callbacks."""
        with self._lock:
            self._exception = exception
            self._exception_fetched = False
            self._done = True
            self._cancelled = False
        self._run_callbacks()

    def _run_callbacks(self) -> None:
        with self._lock:
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            self._schedule(callback)

    def _schedule(self, callback: Callable[[Any], Any]) -> None:
        executor = self._executor() if self._executor is not None else None
        if (
            executor is not None
            and not getattr(executor, "is_shutdown", False)
            and not getattr(callback, "_immediate", False)
        ):
            executor.create_task(callback, self)
            return
        try:
            callback(self)
        except Exception as error:
            warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)

    def _set_executor(self, executor: Any) -> None:
        self._executor = weakref.ref(executor) if executor is not None else None

    def add_done_callback(self, callback: Callable[[Any], Any]) -> None:
        """Have a function called with this future when it is done; at once when it is."""
        with self._lock:
            if not self._done and not self._cancelled:
                self._callbacks.append(callback)
                return
        self._schedule(callback)

    def remove_done_callback(self, callback: Callable[[Any], Any]) -> bool:
        """Remove a function; tells whether it was there."""
        with self._lock:
            before = len(self._callbacks)
            self._callbacks = [known for known in self._callbacks if known != callback]
            return len(self._callbacks) < before


class Task(Future):
    """Runs a function or coroutine; call it to let it go on to its next await."""

    def __init__(
        self,
        handler: Callable[..., Any] | Coroutine[Any, Any, Any],
        args: Any = None,
        kwargs: Any = None,
        executor: Any = None,
    ) -> None:
        super().__init__(executor=executor)
        self._args = args if args is not None else []
        self._kwargs = kwargs if kwargs is not None else {}
        if inspect.iscoroutinefunction(handler):
            handler = handler(*self._args, **self._kwargs)
            self._args, self._kwargs = [], {}
        self._handler: Any = handler
        self._executing = False
        self._step_lock = threading.Lock()
        self.awaited: Future | None = None

    def __call__(self) -> None:
        """Run to the end or the next await; does nothing while another thread does so."""
        if self._done or self._executing or not self._step_lock.acquire(blocking=False):
            return
        try:
            if self._done:
                return
            self._executing = True
            if isinstance(self._handler, CoroutineType):
                self._step_coroutine()
            else:
                self._finish(self._handler(*self._args, **self._kwargs), None)
        except StopIteration as stop:
            self._finish(stop.value, None)
        except Exception as error:
            self._finish(None, error)
        finally:
            self._executing = False
            self._step_lock.release()

    def _step_coroutine(self) -> None:
        if self._cancelled:
            self._handler.close()
            return
        yielded = self._handler.send(None)
        self.awaited = yielded if isinstance(yielded, Future) else None

    def _finish(self, result: Any, error: BaseException | None) -> None:
        self._handler, self._args, self._kwargs = None, None, None
        if error is not None:
            self.set_exception(error)
        elif inspect.iscoroutine(result):
            self._handler, self._args, self._kwargs = result, [], {}
        else:
            self.set_result(result)

    def ready(self) -> bool:
        """Tell whether calling it would make progress."""
        awaited = self.awaited
        return awaited is None or awaited.done() or awaited.cancelled()

    def executing(self) -> bool:
        """Tell whether it is running right now."""
        return self._executing

    def cancel(self) -> None:
        """Cancel, closing a coroutine that has begun."""
        if self._done:
            return
        if isinstance(self._handler, CoroutineType) and not self._executing:
            self._handler.close()
        super().cancel()
