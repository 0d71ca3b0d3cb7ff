"""Simulations that do not depend on each other, side by side on threads: the compiled step lets them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

Task = TypeVar("Task")
Done = TypeVar("Done")

_workers: ContextVar[tuple[Executor, int] | None] = ContextVar("workers", default=None)


@contextmanager
def side_by_side(jobs: int) -> Iterator[None]:
    """Within it, simulations that do not depend on each other run on `jobs` threads: the compiled step lets them."""
    with ThreadPoolExecutor(jobs) as pool:
        token = _workers.set((pool, jobs))
        try:
            yield
        finally:
            _workers.reset(token)


def each(task: Callable[[Task], Done], over: Iterable[Task]) -> list[Done]:
    """The task done for each, on the threads there are."""
    workers = _workers.get()
    return list(map(task, over) if workers is None else workers[0].map(task, over))


def threads() -> int:
    """How many threads there are."""
    workers = _workers.get()
    return 1 if workers is None else workers[1]
