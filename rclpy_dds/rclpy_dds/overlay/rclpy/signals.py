"""SIGINT and SIGTERM shut contexts down, even while the main thread waits inside Cyclone DDS."""

from __future__ import annotations

import contextlib
import signal
import socket
import threading
from enum import IntEnum
from typing import Any

from rclpy.context import open_contexts
from rclpy.exceptions import InvalidHandle
from rclpy_dds.wire.interruptions import waits


class SignalHandlerOptions(IntEnum):
    """Which signals rclpy handles."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


class _Handlers:
    """The handlers that are installed, what was there before, and the thread that hears of signals at once.

    Python runs its handlers only between byte codes of the main thread, which may be waiting in C. So signal numbers
    also go through a socket to a thread that ends the contexts, which in turn ends the wait.
    """

    def __init__(self) -> None:
        self.installed = SignalHandlerOptions.NO
        self.previous: dict[int, Any] = {}
        self.sockets: tuple[socket.socket, socket.socket] | None = None
        self.previous_fd = -1

    def install(self, options: SignalHandlerOptions) -> None:
        if options == self.installed or threading.current_thread() is not threading.main_thread():
            return
        self.uninstall()
        if options == SignalHandlerOptions.NO:
            return
        self.sockets = socket.socketpair()
        for end in self.sockets:
            end.setblocking(False)
        self.previous_fd = signal.set_wakeup_fd(self.sockets[1].fileno(), warn_on_full_buffer=False)
        wanted = [n for n, o in ((signal.SIGINT, 1), (signal.SIGTERM, 2)) if options & o]
        for number in wanted:
            self.previous[number] = signal.signal(number, self._on_signal)
        self.sockets[0].setblocking(True)
        threading.Thread(target=_listen, args=(self.sockets[0], wanted), name="rclpy_signals", daemon=True).start()
        self.installed = options

    def uninstall(self) -> bool:
        if self.installed == SignalHandlerOptions.NO:
            return False
        if threading.current_thread() is not threading.main_thread():
            return False
        for number, handler in self.previous.items():
            if signal.getsignal(number) == self._on_signal:
                signal.signal(number, handler if handler is not None else signal.SIG_DFL)
        self.previous.clear()
        signal.set_wakeup_fd(self.previous_fd)
        if self.sockets is not None:
            self.sockets[1].close()  # the thread reads the end and goes
            self.sockets = None
        self.installed = SignalHandlerOptions.NO
        return True

    def _on_signal(self, number: int, frame: Any) -> None:
        if waits(number):
            return
        _end_contexts()
        previous = self.previous.get(number)
        if callable(previous):
            previous(number, frame)


def _listen(receiver: socket.socket, numbers: list[int]) -> None:
    with contextlib.suppress(OSError), receiver:
        while data := receiver.recv(64):
            if any(number in data for number in numbers):
                _end_contexts()


def _end_contexts() -> None:
    for context in open_contexts():
        with context._lock:
            if context._valid:
                context._end()


_handlers = _Handlers()


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Handle the chosen signals. Python allows that in the main thread only; elsewhere this does nothing."""
    _handlers.install(SignalHandlerOptions(options))


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return which signals are handled."""
    return _handlers.installed


def uninstall_signal_handlers() -> bool:
    """Put back the handlers that were there before; False when none of rclpy's are installed."""
    return _handlers.uninstall()


class SignalHandlerGuardCondition:
    """Not offered: contexts wake their executors themselves."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise InvalidHandle(
            "rclpy_dds has no SignalHandlerGuardCondition; use a real ROS 2 for it (https://docs.ros.org)"
        )
