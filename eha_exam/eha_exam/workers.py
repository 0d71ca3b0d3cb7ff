"""Recordings and diagnoses spread over the processes of this machine, or over the workers of a Dask scheduler."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

from eha_exam.errors import ExamError


@dataclass(frozen=True)
class Workers:
    """Where the work is done: `jobs` processes, or the workers of the scheduler at `dask`, which see the folder."""

    jobs: int = 1
    dask: str | None = None

    def run(self, function: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Iterator[Any]:
        """Results as they come, in any order; the first exception ends it."""
        if self.dask is not None:
            yield from self._on_dask(function, calls)
            return
        with ProcessPoolExecutor(self.jobs, mp_context=get_context("spawn")) as pool:
            try:
                for future in as_completed([pool.submit(function, *call) for call in calls]):
                    yield future.result()
            finally:
                pool.shutdown(wait=False, cancel_futures=True)

    def _on_dask(self, function: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Iterator[Any]:
        try:
            from dask import distributed
        except ImportError:
            raise ExamError("--dask needs the package `distributed`; install it or use --jobs") from None
        try:
            client = distributed.Client(self.dask, timeout=5)
        except (OSError, ValueError, TimeoutError) as error:
            raise ExamError(f"--dask {self.dask}: no scheduler answers there ({error}); use --jobs") from None
        with client:
            futures = [client.submit(function, *call, pure=False) for call in calls]
            for future in distributed.as_completed(futures):
                yield future.result()
