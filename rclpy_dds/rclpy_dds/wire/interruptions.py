"""Signals wait while cyclonedds calls Python from C, which would turn what a handler raises into another error."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_depth = 0
_waiting: list[int] = []


@contextmanager
def held_off() -> Iterator[None]:
    """Let the signals that come in this block, whose handlers run in the main thread, be handled after it."""
    global _depth
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _depth += 1
    try:
        yield
    finally:
        _depth -= 1
        while _waiting and not _depth:
            signal.raise_signal(_waiting.pop())


def waits(number: int) -> bool:
    """Tell a handler whether its signal has to wait; it then comes again."""
    if _depth:
        _waiting.append(number)
    return _depth > 0
