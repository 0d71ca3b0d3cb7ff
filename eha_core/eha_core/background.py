"""A process of low priority that does one thing after another, and never keeps its owner waiting."""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from eha_core.errors import EhaError

NICENESS = 10
"""Of the process, so that its owner's timers come first where the machine is busy (assumed)."""

Done = tuple[Callable[..., Any], Any]
"""A function, and what it returned or the exception that it raised."""


class Background:
    """Does what it is given in a process of its own, in that order; the process ends with its owner.

    Args:
        prepare: called there first, before anybody waits: imports and compiled code take seconds.
    """

    def __init__(self, prepare: Callable[[], object]) -> None:
        context = get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, prepare), daemon=True)
        self._process.start()
        theirs.close()  # so that the end of the process is noticed
        self._waiting: deque[tuple[Callable[..., Any], tuple[Any, ...]]] = deque()
        self._running: Callable[..., Any] | None = prepare

    @property
    def is_idle(self) -> bool:
        """Whether all is done and was returned by `results`."""
        return self._running is None and not self._waiting

    def submit(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Have `function(*arguments)` called; both are pickled, and so is what comes of it."""
        self._waiting.append((function, arguments))

    def results(self) -> list[Done]:
        """What was done since the last call, `prepare` too. It returns at once and gives the process its next job, so
        call it regularly. Where the process has ended, each job's outcome is an EhaError."""
        done: list[Done] = []
        while self._running is None or self._connection.poll():
            if self._running is not None:
                done.append((self._running, self._outcome()))
                self._running = None
            if not self._waiting:
                break
            self._running, arguments = self._waiting.popleft()
            with suppress(OSError):  # it has ended, as the outcome says
                self._connection.send((self._running, arguments))
        return done

    def _outcome(self) -> Any:
        try:
            return self._connection.recv()
        except (EOFError, OSError):
            return EhaError("the process that should do it has ended; is there memory enough?")

    def close(self, patience: float) -> list[Done]:
        """End the process, after what it was given if that takes no longer than `patience` [s]; as `results`."""
        deadline = time.monotonic() + patience
        done = self.results()
        while not self.is_idle and time.monotonic() < deadline:
            self._connection.poll(0.05)
            done += self.results()
        self._process.terminate()
        self._process.join()
        self._connection.close()
        return done


def _serve(connection: Connection, prepare: Callable[[], object]) -> None:
    # a terminal tells all its processes of a Ctrl-C; this one ends when its owner does
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    os.nice(NICENESS)
    function, arguments = prepare, ()
    with suppress(EOFError, OSError):
        while True:
            connection.send(_done(function, arguments))
            function, arguments = connection.recv()


def _done(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    try:
        return function(*arguments)
    except Exception as error:  # whoever asked gets it
        return error
