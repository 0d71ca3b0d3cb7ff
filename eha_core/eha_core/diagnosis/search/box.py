"""The minimum of a quadratic form within bounds: what a linear model predicts of coefficients that have limits."""

from __future__ import annotations

import numpy as np

from eha_core.compiled import compiled
from eha_core.identification.numbers import Array, Integers

PASSES = 60
"""Exchanges of bounds after which a solution is taken as it stands; few need more than five."""

SINGULAR = 1e-12
"""Share of a diagonal element that elimination leaves of it where its column is one of the others."""

ROUNDING = 1e-9
"""Share of a coefficient, or of a slope, that is no violation of a bound."""


@compiled
def within_bounds(
    matrix: Array, gradient: Array, lower: Array, upper: Array, places: Integers, count: int, found: Array
) -> float:
    """Minimise x' M x - 2 g' x over the first `count` of `places`, each within its bounds; `found` becomes that x.

    Returns what is gained over x = 0, or -1 where the matrix is not positive definite there. Block principal pivoting:
    all violated bounds are exchanged at once, and one by one where that no longer helps (Kim and Park, 2011).
    """
    side = np.zeros(count, np.int64)
    wanted = np.zeros(count, np.int64)
    fewest, chances = count + 1, 3
    for _ in range(PASSES):
        for k in range(count):
            if side[k] != 0:
                found[k] = lower[places[k]] if side[k] < 0 else upper[places[k]]
        if not _solve_between(matrix, gradient, places, side, found):
            return -1.0
        wrong, last = 0, -1
        for k in range(count):
            wanted[k] = _side_of(matrix, gradient, lower, upper, places, side, found, k)
            if wanted[k] != side[k]:
                wrong, last = wrong + 1, k
        if wrong == 0:
            break
        chances = 3 if wrong < fewest else chances - 1
        fewest = min(fewest, wrong)
        for k in range(count):
            if chances >= 0 or k == last:
                side[k] = wanted[k]
    gain = 0.0
    for k in range(count):
        total = 2.0 * gradient[places[k]]
        for other in range(count):
            total -= matrix[places[k], places[other]] * found[other]
        gain += total * found[k]
    return gain


@compiled
def _solve_between(matrix: Array, gradient: Array, places: Integers, side: Integers, found: Array) -> bool:
    """Minimise over the coefficients that are at no bound, the others as `found` has them (Cholesky); False where the
    matrix is not positive definite."""
    count, size = len(side), 0
    index = np.empty(count, np.int64)
    for k in range(count):
        if side[k] == 0:
            index[size] = k
            size += 1
    factor, right = np.zeros((size, size)), np.empty(size)
    for row in range(size):
        at = places[index[row]]
        total = gradient[at]
        for k in range(count):
            if side[k] != 0:
                total -= matrix[at, places[k]] * found[k]
        for column in range(row + 1):
            value = matrix[at, places[index[column]]]
            for k in range(column):
                value -= factor[row, k] * factor[column, k]
            if column < row:
                factor[row, column] = value / factor[column, column]
                total -= factor[row, column] * right[column]
            elif value <= SINGULAR * matrix[at, at]:
                return False
            else:
                factor[row, row] = np.sqrt(value)
        right[row] = total / factor[row, row]
    for row in range(size - 1, -1, -1):
        total = right[row]
        for k in range(row + 1, size):
            total -= factor[k, row] * found[index[k]]
        found[index[row]] = total / factor[row, row]
    return True


@compiled
def _side_of(
    matrix: Array, gradient: Array, lower: Array, upper: Array, places: Integers, side: Integers, found: Array, k: int
) -> int:
    """Where a coefficient should be: -1 at its lower bound, 1 at its upper one, 0 between them."""
    at = places[k]
    if side[k] == 0:
        slack = ROUNDING * (abs(found[k]) + 1e-300)
        return -1 if found[k] < lower[at] - slack else 1 if found[k] > upper[at] + slack else 0
    slope, size = gradient[at], abs(gradient[at])
    for other in range(len(side)):
        part = matrix[at, places[other]] * found[other]
        slope -= part
        size += abs(part)
    return 0 if side[k] * slope < -ROUNDING * size else side[k]
