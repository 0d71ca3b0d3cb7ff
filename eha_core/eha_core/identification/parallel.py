"""Simulations and fits that do not depend on each other, side by side on threads: the compiled step lets them."""

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
    """Within it, what `each` is given runs on `jobs` threads; what such a task gives to `each` in turn, on its own."""
    pool = ThreadPoolExecutor(jobs)
    token = _workers.set((pool, jobs))
    try:
        yield
    finally:
        _workers.reset(token)
        pool.shutdown(cancel_futures=True)  # an interrupt need not wait for what has not begun


def each(
    task: Callable[[Task], Done], over: Iterable[Task], announce: Callable[[Task], None] = lambda _: None
) -> list[Done]:
    """The task done for each, on the threads there are; each is announced before it is waited for."""
    workers, items = _workers.get(), list(over)
    results = map(task, items) if workers is None else workers[0].map(task, items)
    done = []
    for item in items:
        announce(item)
        done.append(next(results))
    return done


def threads() -> int:
    """How many threads there are."""
    workers = _workers.get()
    return 1 if workers is None else workers[1]
