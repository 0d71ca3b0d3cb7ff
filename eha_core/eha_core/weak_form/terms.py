"""Sparse regression: the fewest terms that explain the observations of an unknown function.

PySINDy's optimisers propose sets of terms: FROLS adds terms one by one, SSR removes them. The Bayesian information
criterion chooses among them and counts every parameter of a term. After B. de Silva et al., "PySINDy", Journal of Open
Source Software 5 (2020), and S. A. Billings, "Nonlinear System Identification" (2013).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import atan2, hypot, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eha_core.identification.numbers import Array

Function = Callable[[Array], Array]

MOST_TERMS = 4
WORTH = 10.0
"""Reduction of the Bayesian information criterion required of another term: very strong evidence by the usual scale."""

SLIGHT = 0.005
"""Share of the variance that it must also explain: many samples do not make a measurement more exact."""

PRECISION = 1e-5
"""Share of the variance that need not be explained: 0.3 % of the amplitude."""

ALIKE = 1.0 - 1e-8
"""Correlation from which two terms count as one."""


@dataclass(frozen=True)
class Term:
    """A function of the variable with free coefficients: `text` as written, `parts` one for each coefficient.

    A sine has two parts, sine and cosine, and `text` is its argument. `searched`: number of inner parameters that were
    searched.
    """

    text: str
    parts: tuple[Function, ...]
    searched: int = 0

    def written(self, coefficients: Sequence[float], times: str = "") -> str:
        """The term with its coefficients, to three digits, times another factor."""
        size, text = coefficients[0], self.text
        if len(self.parts) == 2:
            size, text = hypot(*coefficients), f"sin({self.text} {signed(atan2(coefficients[1], coefficients[0]))})"
        factors = [factor for factor in (number(size), "" if text == "1" else text, times) if factor]
        return " ".join(factors)


@dataclass(frozen=True)
class RegressionData:
    """Observations of an unknown function of `at` (times,).

    `rows` maps any function's values (..., times) to observations (..., n); `seen` (n,) are the actual ones. `total`:
    the sum of squares to be explained. `independent`: the number of independent observations among the n.
    """

    at: Array
    seen: Array
    rows: Callable[[Array], Array]
    total: float
    independent: float


@dataclass(frozen=True)
class Sum:
    """Terms with their coefficients, the share of the variance that they explain, and their information criterion."""

    terms: tuple[Term, ...]
    coefficients: tuple[tuple[float, ...], ...]
    r_squared: float
    criterion: float

    def values(self, at: Array) -> Array:
        """The sum at values of the variable."""
        found = np.zeros_like(at)
        for term, sizes in zip(self.terms, self.coefficients, strict=True):
            for part, size in zip(term.parts, sizes, strict=True):
                found += size * part(at)
        return found

    def written(self, times: str = "") -> str:
        """The sum as a formula; empty without terms."""
        pairs = zip(self.terms, self.coefficients, strict=True)
        return " + ".join(term.written(sizes, times) for term, sizes in pairs).replace("+ -", "- ")


def sparsest(data: RegressionData, terms: Sequence[Term]) -> Sum:
    """The sum of fewest terms that is not clearly worse than a longer one; without terms where none is significant."""
    columns = [_columns(data, term) for term in terms]
    sums = [
        _solved(data, [terms[k] for k in support], [columns[k] for k in support])
        for support in _supports(data, columns)
    ]
    best = _solved(data, [], [])
    for count in range(1, MOST_TERMS + 1):
        nearest = min(
            (candidate for candidate in sums if len(candidate.terms) == count),
            key=lambda candidate: candidate.criterion,
            default=best,
        )
        if nearest.criterion < best.criterion - WORTH and nearest.r_squared > best.r_squared + SLIGHT:
            best = nearest
    return best


def fitted(data: RegressionData, terms: Sequence[Term]) -> Sum:
    """Least squares over the parts of the terms."""
    return _solved(data, terms, [_columns(data, term) for term in terms])


def _columns(data: RegressionData, term: Term) -> Array:
    """The observations of each part of a term: (parts, n)."""
    return data.rows(np.stack([part(data.at) for part in term.parts]))


def _solved(data: RegressionData, terms: Sequence[Term], columns: Sequence[Array]) -> Sum:
    left = data.seen
    solved = np.empty(0)
    if terms:
        matrix = np.concatenate(columns).T
        lengths = np.linalg.norm(matrix, axis=0)
        lengths = np.where(lengths > 0.0, lengths, 1.0)
        solved = np.linalg.lstsq(matrix / lengths, left, rcond=None)[0] / lengths
        left = left - matrix @ solved
    share = float(left @ left) / data.total
    numbers = len(solved) + sum(term.searched for term in terms)
    criterion = data.independent * log(share + PRECISION) + numbers * log(data.independent)
    sizes = iter(float(size) for size in solved)
    coefficients = tuple(tuple(next(sizes) for _ in term.parts) for term in terms)
    return Sum(tuple(terms), coefficients, 1.0 - share, criterion)


def _supports(data: RegressionData, columns: Sequence[Array]) -> list[tuple[int, ...]]:
    """Sets of terms to try: each alone, each pair, and the longer ones that greedy optimisers visit."""
    from pysindy.optimizers import FROLS, SSR  # takes a second to import, and few recordings need it

    owners = [k for k, parts in enumerate(columns) for _ in parts]
    stacked = np.concatenate(columns)
    lengths = np.linalg.norm(stacked, axis=1)
    unit = stacked / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    distinct = _apart(unit)
    if not distinct or not np.any(data.seen):
        return []
    there = sorted({owners[k] for k in distinct})
    found = {*combinations(there, 1), *combinations(there, 2)}
    target = data.seen[:, None] / np.linalg.norm(data.seen)
    most = min(MOST_TERMS + 1, len(distinct))
    for optimiser in (FROLS(max_iter=most, alpha=1e-9), SSR(max_iter=len(distinct), alpha=1e-9)):
        for used in _passed(optimiser, unit[distinct].T, target):
            support = tuple(sorted({owners[distinct[k]] for k in used}))
            if 0 < len(support) <= MOST_TERMS:
                found.add(support)
    return sorted(found)


def _apart(unit: Array) -> list[int]:
    """Indices of the columns (k, n) of unit length that are not zero and not a duplicate of an earlier one."""
    alike = np.abs(unit @ unit.T)
    found: list[int] = []
    for k in range(len(unit)):
        if alike[k, k] > 0.5 and np.all(alike[k, found] < ALIKE):
            found.append(k)
    return found


def _passed(optimiser: Any, columns: Array, target: Array) -> Iterator[NDArray[np.intp]]:
    """The sets of columns that an optimiser visits; empty where columns are linearly dependent."""
    with warnings.catch_warnings():
        # nearly dependent columns are expected: the criterion decides on the result
        warnings.simplefilter("ignore")
        try:
            optimiser.fit(columns, target)
        except (ValueError, np.linalg.LinAlgError):
            return
    for coefficients in optimiser.history_:
        yield np.flatnonzero(np.ravel(coefficients))


def number(value: float) -> str:
    """Three digits, the exponent without padding: 2.1e4."""
    digits, _, exponent = f"{value:.3g}".partition("e")
    return f"{digits}e{int(exponent)}" if exponent else digits


def signed(value: float) -> str:
    """A number to be added, with its sign before it: "+ 0.52"."""
    return f"{'-' if value < 0.0 else '+'} {number(abs(value))}"
