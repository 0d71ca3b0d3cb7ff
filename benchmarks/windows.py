"""A fit's damped step over many windows: banded elimination beside LAPACK's Cholesky of the same matrix, dense."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from threadpoolctl import threadpool_limits

from benchmarks.row import Row
from eha_core.identification.normal_matrix import NormalMatrix

WINDOWS = (12, 50, 100, 200, 400)  # a second each
PARAMETERS, STATES = 12, 4
DAMPING = 1e-6
ENOUGH = 0.3  # s; each is repeated for so long

Array = NDArray[np.float64]


def measure() -> list[Row]:
    """Time both on one thread, as a diagnosis runs them."""
    with threadpool_limits(1):
        return [_row(windows) for windows in WINDOWS]


def equations(windows: int) -> tuple[NormalMatrix, Array]:
    """Random normal equations of so many windows, well conditioned."""
    generator = np.random.default_rng(windows)
    data = generator.standard_normal((windows, 20, STATES))
    effect = generator.standard_normal((windows, 20, PARAMETERS))
    links = generator.standard_normal((windows - 1, STATES, STATES))
    own = np.swapaxes(data, 1, 2) @ data
    own[:-1] += np.swapaxes(links, 1, 2) @ links
    own[1:] += np.eye(STATES)
    flat = effect.reshape(-1, PARAMETERS)
    matrix = NormalMatrix(flat.T @ flat, np.swapaxes(data, 1, 2) @ effect, own, -np.swapaxes(links, 1, 2))
    return matrix, generator.standard_normal(PARAMETERS + STATES * windows)


def banded(matrix: NormalMatrix, right: Array) -> Array:
    """The damped system's solution as a fit takes it."""
    return matrix.eliminate(DAMPING).solve(right)


def dense(matrix: NormalMatrix, right: Array) -> Array:
    """The same from the whole matrix, putting it together included."""
    size, windows = len(right), len(matrix.own)
    full = np.zeros((size, size))
    full[:PARAMETERS, :PARAMETERS] = matrix.parameters
    full[PARAMETERS:, :PARAMETERS] = matrix.border
    for window in range(windows):
        here = slice(PARAMETERS + STATES * window, PARAMETERS + STATES * (window + 1))
        full[here, here] = matrix.own[window]
        if window:
            full[here, here.start - STATES : here.start] = matrix.following[window - 1].T
    full[np.diag_indices(size)] *= 1.0 + DAMPING
    return np.asarray(cho_solve(cho_factor(full, lower=True, overwrite_a=True), right))


def _row(windows: int) -> Row:
    matrix, right = equations(windows)
    ours, theirs = (_seconds(lambda solve=solve: solve(matrix, right)) for solve in (banded, dense))  # type: ignore[misc]
    return Row(
        f"a fit's step over {windows} windows and {PARAMETERS} parameters",
        f"{ours * 1e3:.2f} ms",
        f"dense Cholesky of LAPACK: {theirs * 1e3:.2f} ms",
        f"{theirs / ours:.3g} x faster" if theirs > ours else f"the peer is ahead, {ours / theirs:.2f} x faster",
        "stated",
        True,
    )


def _seconds(action: Callable[[], object]) -> float:
    """The shortest of a few runs."""
    best, until = np.inf, perf_counter() + ENOUGH
    while perf_counter() < until:
        begun = perf_counter()
        action()
        best = min(best, perf_counter() - begun)
    return float(best)
