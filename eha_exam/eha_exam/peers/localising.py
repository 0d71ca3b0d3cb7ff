"""A sparse regression for each balance, in which only blocks of time that were not fitted say what a term is worth.

A balance is cut into BLOCKS blocks of time. Each is held out once: the regression is fitted to the rows that share no
sample with it, and errs on it. Terms are added one at a time, the one that lowers the held-out squared error most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eha_exam.peers.equations import HALF_WIDTH, HOP, Equation

Array = NDArray[np.float64]

BLOCKS = 10
NEARLY_ALL = 9
"""Blocks (assumed), and in how many of them a term must lower the squared error ..."""
MARGIN = 0.2
"""... and the share by which it must do so. This, CLEAR and RIVAL had the most right and the fewest wrong on recordings
that no result is stated of."""
MOST_TERMS = 3
"""Of one balance (assumed)."""
CLEAR = 0.5
"""Share of the held-out squared residual that all terms together must explain for the balance to be a site."""
RIVAL = 0.1
"""A term is a rival of the best where the held-out squared error with it is higher by no more than this share."""


@dataclass(frozen=True)
class Finding:
    """What is found in one balance: terms that passed, for each the rivals that might stand in its place, and shares of
    the held-out squared residual that those terms, and that all terms together, explain."""

    site: str
    terms: tuple[str, ...]
    rivals: tuple[tuple[str, ...], ...]
    explained: float
    explained_by_all: float


def localise(row: Equation) -> Finding:
    """What passes the held-out tests of one balance."""
    names = row.effects
    bare = held_out(row, [])
    chosen: list[int] = []
    rivals: list[tuple[str, ...]] = []
    error = bare
    while len(chosen) < MOST_TERMS:
        errors = {j: held_out(row, [*chosen, j]) for j in range(len(names)) if j not in chosen}
        passed = {j: one for j, one in errors.items() if np.count_nonzero(one < (1.0 - MARGIN) * error) >= NEARLY_ALL}
        if not passed:
            break
        best = min(passed, key=lambda j: float(passed[j].sum()))
        near = (1.0 + RIVAL) * passed[best].sum()
        rivals.append(tuple(names[j] for j, one in passed.items() if j != best and one.sum() <= near))
        chosen.append(best)
        error = passed[best]
    together = held_out(row, list(range(len(names))))
    shares = [1.0 - float(one.sum() / bare.sum()) for one in (error, together)]
    return Finding(row.site, tuple(names[j] for j in chosen), tuple(rivals), *shares)


def held_out(row: Equation, terms: list[int]) -> Array:
    """Squared error of each block of time (BLOCKS,), predicted from the rows that share no sample with it by the
    nominal terms and the candidates of these numbers."""
    columns = np.column_stack([row.nominal, row.candidates[:, terms]])
    columns = columns / (np.linalg.norm(columns, axis=0) + 1e-300)
    edges = np.linspace(0, len(row.target), BLOCKS + 1).astype(int)
    overlap = round(2.0 * HALF_WIDTH / HOP)
    errors = []
    for first, last in zip(edges[:-1], edges[1:], strict=True):
        seen = np.r_[0 : max(first - overlap, 0), last + overlap : len(row.target)]
        sizes = np.linalg.lstsq(columns[seen], row.target[seen], rcond=None)[0]
        errors.append(float(np.sum((row.target[first:last] - columns[first:last] @ sizes) ** 2)))
    return np.array(errors)
