"""A thread that finishes what it was given, whatever interrupts the thread that waits for it."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable
from queue import SimpleQueue
from typing import TypeAlias

_Outcome: TypeAlias = "SimpleQueue[BaseException | None]"
_Actions: TypeAlias = "SimpleQueue[tuple[Callable[[], None], _Outcome] | None]"


class OwnThread:
    """Does actions one after another, each to its end; it ends with its owner.

    Python raises KeyboardInterrupt in the main thread, between any two of its steps. A `SimpleQueue` hands over in one
    step of C, so nothing is left half done; an executor or a condition takes its locks in Python, and an interrupt
    between two lines leaves them taken for ever.

    Args:
        name: the thread's name, as debuggers and `threading.enumerate` show it.
    """

    def __init__(self, name: str) -> None:
        self._actions: _Actions = SimpleQueue()
        threading.Thread(target=_serve, args=(self._actions,), name=name, daemon=True).start()
        weakref.finalize(self, self._actions.put, None)

    def do(self, action: Callable[[], None]) -> None:
        """Have an action done, also when the wait for its end is interrupted; raises what it raised."""
        outcome: _Outcome = SimpleQueue()
        self._actions.put((action, outcome))
        if (error := outcome.get()) is not None:
            raise error

    def end(self) -> None:
        """Let the thread end after what it was given so far."""
        self._actions.put(None)


def _serve(actions: _Actions) -> None:
    while (given := actions.get()) is not None:
        action, outcome = given
        try:
            action()
        except BaseException as error:  # whoever waits gets it
            outcome.put(error)
        else:
            outcome.put(None)
        del given, action, outcome  # while it waits it keeps nobody's file open
