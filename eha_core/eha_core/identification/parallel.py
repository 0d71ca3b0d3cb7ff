"""Independent simulations and fits in parallel threads; the compiled step releases the interpreter's lock."""

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
    """A context in which `each` runs its tasks on `jobs` threads; a nested `each` runs in its task's thread."""
    pool = ThreadPoolExecutor(jobs)
    token = _workers.set((pool, jobs))
    try:
        yield
    finally:
        _workers.reset(token)
        pool.shutdown(cancel_futures=True)  # an interrupt does not wait for tasks that have not begun


def each(
    task: Callable[[Task], Done], over: Iterable[Task], announce: Callable[[Task], None] = lambda _: None
) -> list[Done]:
    """The results of the task for each element, on the available threads; each is announced before it is awaited."""
    workers, items = _workers.get(), list(over)
    results = map(task, items) if workers is None else workers[0].map(task, items)
    done = []
    for item in items:
        announce(item)
        done.append(next(results))
    return done


def threads() -> int:
    """The number of available threads."""
    workers = _workers.get()
    return 1 if workers is None else workers[1]
