"""Recordings and diagnoses spread over the processes of this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any


def in_parallel(function: Callable[..., Any], calls: Sequence[tuple[Any, ...]], jobs: int) -> Iterator[Any]:
    """Results of `function` for the arguments of each call as they come, from `jobs` processes; the first exception
    ends it."""
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"))
    try:
        yield from (future.result() for future in as_completed([pool.submit(function, *call) for call in calls]))
    finally:
        pool.shutdown(cancel_futures=True)
