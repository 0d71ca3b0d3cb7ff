"""What rclpy.init() makes and rclpy.shutdown() ends: one participant in the domain, and who wants to know."""

from __future__ import annotations

import atexit
import contextlib
import sys
import threading
import weakref
from collections.abc import Callable, Iterator
from types import MethodType, TracebackType
from typing import Any

from cyclonedds.qos import Policy, Qos

from rclpy_dds import arguments as _arguments
from rclpy_dds.wire import domain, entities
from rclpy_dds.wire.graph import Graph

g_logging_ref_count = 0
_open: weakref.WeakSet[Context] = weakref.WeakSet()


class Context:
    """The lifetime between init and shutdown that nodes share."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._participant: entities.Participant | None = None
        self._graph: Graph | None = None
        self._callbacks: list[Callable[[], None] | weakref.WeakMethod[Any]] = []
        self._guards: weakref.WeakSet[Any] = weakref.WeakSet()
        self._valid = False
        self._initialized = False
        self.arguments = _arguments.Arguments()
        self.entities_version = 0
        self._domain_id = 0

    def init(
        self, args: list[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Read arguments and join the domain.

        Raises:
            RuntimeError: initialised already, or the domain cannot be joined.
            UnknownROSArgsError, RCLInvalidROSArgsError, UnicodeEncodeError: the arguments cannot be understood.
        """
        from rclpy.exceptions import RCLInvalidROSArgsError, UnknownROSArgsError

        with self._lock:
            if self._initialized:
                raise RuntimeError("Context.init() must only be called once")
            if domain_id is not None and domain_id < 0:
                raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
            for argument in args or ():
                argument.encode()  # undecodable bytes of the command line show as lone surrogates and raise here
            try:
                self.arguments = _arguments.parse(sys.argv if args is None else args)
            except _arguments.UnknownRosArguments as error:
                raise UnknownROSArgsError(error.args[0]) from None
            except ValueError as error:
                raise RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {error}") from None
            self._domain_id = domain.default_domain_id() if domain_id is None else domain_id
            user_data = Policy.Userdata(f"enclave={self.arguments.enclave};".encode())
            self._participant = entities.Participant(self._domain_id, Qos(user_data))
            self._graph = Graph(self._participant)
            self._initialized = self._valid = True
            _open.add(self)
        if initialize_logging:
            self._apply_log_levels()

    def _apply_log_levels(self) -> None:
        import rclpy.impl.rcutils_logger as loggers
        from rclpy.impl.logging_severity import LoggingSeverity

        for name, level in self.arguments.log_levels:
            loggers.set_level(name, LoggingSeverity[level])
        loggers.console_enabled = self.arguments.console

    @property
    def participant(self) -> entities.Participant:
        """Return this context's DDS participant.

        Raises:
            NotInitializedException: there is none yet, or no more.
        """
        from rclpy.exceptions import NotInitializedException

        if self._participant is None:
            raise NotInitializedException()
        return self._participant

    @property
    def graph(self) -> Graph:
        """Return this context's view of the domain.

        Raises:
            NotInitializedException: there is none yet, or no more.
        """
        from rclpy.exceptions import NotInitializedException

        if self._graph is None:
            raise NotInitializedException()
        return self._graph

    def get_domain_id(self) -> int:
        """Return the domain this context is in."""
        self.participant  # noqa: B018 - raises where there is none
        return self._domain_id

    def ok(self) -> bool:
        """Tell whether the context is between init and shutdown."""
        return self._valid

    def changed(self) -> None:
        """Note that entities were made or destroyed, so that executors look again."""
        self.entities_version += 1

    def shutdown(self) -> None:
        """End the context and leave the domain.

        Raises:
            RuntimeError: it is not initialised, or ended already.
        """
        with self._lock:
            if not self._valid:
                raise RuntimeError("Context must be initialized before it can be shutdown")
            self._end()
        self._leave()

    def try_shutdown(self) -> None:
        """End the context if it has not ended."""
        with self._lock:
            if self._valid:
                self._end()
        self._leave()

    def destroy(self) -> None:
        """End the context if it has not ended, and forget it."""
        self.try_shutdown()

    def _end(self) -> None:
        """Become invalid, wake every executor and tell who asked for it."""
        self._valid = False
        for guard in list(self._guards):
            with contextlib.suppress(Exception):
                guard.trigger()
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            function = callback() if isinstance(callback, weakref.WeakMethod) else callback
            if function is not None:
                function()

    def _leave(self) -> None:
        with self._lock:
            participant, self._participant, self._graph = self._participant, None, None
        if participant is not None:
            entities.delete(participant.handle)

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        """Have a function called at shutdown; at once when that has been.

        Raises:
            TypeError: it is not callable.
        """
        if not callable(callback):
            raise TypeError(f"callback should be a callable, got {type(callback)}")
        with self._lock:
            if not self._valid:
                callback()
            elif isinstance(callback, MethodType):
                self._callbacks.append(weakref.WeakMethod(callback))
            else:
                self._callbacks.append(callback)

    def _forget_on_shutdown(self, callback: Callable[[], None]) -> None:
        with self._lock:
            self._callbacks = [
                known for known in self._callbacks
                if (known() if isinstance(known, weakref.WeakMethod) else known) not in (callback, None)
            ]  # fmt: skip

    @property
    def handle(self) -> Any:
        """Return an object to use in a with statement, as code written for rclpy does."""
        return contextlib.nullcontext(self)

    def __enter__(self) -> Context:
        self.init()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.try_shutdown()


def open_contexts() -> Iterator[Context]:
    """Yield every context that was initialised and still exists."""
    yield from list(_open)


@atexit.register
def _leave_all() -> None:
    """Take every participant off the graph when the interpreter ends; otherwise others see its nodes for 10 s more."""
    for context in open_contexts():
        context._valid = False
        context._leave()
