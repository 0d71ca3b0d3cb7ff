"""A thread that completes its actions even if the thread that waits for them is interrupted."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable
from queue import SimpleQueue
from typing import TypeAlias

_Outcome: TypeAlias = "SimpleQueue[BaseException | None]"
_Actions: TypeAlias = "SimpleQueue[tuple[Callable[[], None], _Outcome] | None]"


class OwnThread:
    """Runs actions one after another, each to its end; it ends with its owner.

    Python raises KeyboardInterrupt in the main thread between any two bytecodes. A `SimpleQueue` transfers an item in
    one step of C, which cannot be interrupted; an executor or a condition takes locks in Python, and an interrupt
    between two lines would leave them locked.

    Args:
        name: the thread's name, as debuggers and `threading.enumerate` show it.
    """

    def __init__(self, name: str) -> None:
        self._actions: _Actions = SimpleQueue()
        threading.Thread(target=_serve, args=(self._actions,), name=name, daemon=True).start()
        weakref.finalize(self, self._actions.put, None)

    def do(self, action: Callable[[], None]) -> None:
        """Run an action to its end, even if the wait for it is interrupted; raises the action's exception."""
        outcome: _Outcome = SimpleQueue()
        self._actions.put((action, outcome))
        if (error := outcome.get()) is not None:
            raise error

    def end(self) -> None:
        """Let the thread end after its pending actions."""
        self._actions.put(None)


def _serve(actions: _Actions) -> None:
    while (given := actions.get()) is not None:
        action, outcome = given
        try:
            action()
        except BaseException as error:  # passed to the waiting thread
            outcome.put(error)
        else:
            outcome.put(None)
        del given, action, outcome  # no reference keeps a file open while the thread waits
