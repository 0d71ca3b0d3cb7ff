"""The normal matrix of multiple shooting: block-tridiagonal in the windows' states, bordered by the parameters.

A window's state is coupled to its own samples, to the parameters and, by the continuity defects, to its two
neighbours. So the states are eliminated by a banded Cholesky factor, the Schur complement remains for the parameters,
and work and memory are proportional to the number of windows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import (
    LinAlgError,
    cho_factor,
    cho_solve,
    cho_solve_banded,
    cholesky,
    cholesky_banded,
    solve_triangular,
)

from eha_core.compiled import compiled
from eha_core.identification.numbers import Array, Flags

RIDGE = 1e-12
"""Added to the scaled matrix' unit diagonal where rounding alone keeps the states' part from being positive definite:
some ten thousand times the rounding error of a double."""

SINGULAR = 1e-13
"""Share of the largest eigenvalue below which one counts as zero in a pseudo-inverse."""


@dataclass(frozen=True)
class NormalMatrix:
    """A symmetric matrix over (parameters, states of window 0, states of window 1, ...), stored as its nonzero blocks.

    Attributes:
        parameters: (parameters, parameters).
        shared: (windows, states, parameters) a window's states with the parameters.
        own: (windows, states, states) a window's states with themselves.
        following: (windows - 1, states, states) a window's states, in rows, with those of the next.
    """

    parameters: Array
    shared: Array
    own: Array
    following: Array

    @property
    def border(self) -> Array:
        """(windows * states, parameters) `shared` as a matrix."""
        windows, size, count = self.shared.shape
        return self.shared.reshape(windows * size, count)

    def diagonal(self) -> Array:
        """(parameters + windows * states,) the main diagonal."""
        return np.concatenate([np.diag(self.parameters), np.einsum("wii->wi", self.own).ravel()])

    def times(self, vector: Array) -> Array:
        """The product with a vector over (parameters, states)."""
        count = len(self.parameters)
        first, rest = vector[:count], vector[count:].reshape(len(self.own), -1)
        states = np.einsum("wij,wj->wi", self.own, rest)
        states[:-1] += np.einsum("wij,wj->wi", self.following, rest[1:])
        states[1:] += np.einsum("wij,wi->wj", self.following, rest[:-1])
        return np.concatenate(
            [self.parameters @ first + self.border.T @ vector[count:], states.ravel() + self.border @ first]
        )

    def eliminate(self, damping: float = 0.0) -> Eliminated:
        """Eliminate the states of the matrix with its diagonal raised by the factor 1 + `damping`.

        Raises:
            LinAlgError: the states' part is not positive definite.
            ValueError: it is not finite.
        """
        scale = np.sqrt(self.diagonal())
        count = len(self.parameters)
        factor = cholesky_banded(_bands(self, scale[count:], damping), lower=True, overwrite_ab=True)
        border = self.border / np.outer(scale[count:], scale[:count])
        carried = np.asarray(cho_solve_banded((factor, True), border))
        inner = self.parameters / np.outer(scale[:count], scale[:count]) + damping * np.eye(count)
        return Eliminated(scale, factor, carried, inner - border.T @ carried)

    def covariance(self) -> Array:
        """The inverse's columns of the parameters: (parameters + windows * states, parameters).

        Directions of the parameters without curvature count as known (a pseudo-inverse). A matrix that is not finite
        gives NaN.
        """
        for ridge in (0.0, RIDGE):
            try:
                return self.eliminate(ridge).columns_of_parameters()
            except LinAlgError:
                continue
            except ValueError:
                break
        return np.full((len(self.diagonal()), len(self.parameters)), np.nan)


@dataclass(frozen=True)
class Eliminated:
    """A normal matrix N after its states were eliminated; all but `scale` belongs to N / outer(scale, scale).

    Attributes:
        scale: square roots of N's diagonal.
        factor: banded Cholesky factor of the states' part.
        carried: (states, parameters) the states' part, inverted, times the border.
        schur: (parameters, parameters) the Schur complement for the parameters.
    """

    scale: Array
    factor: Array
    carried: Array
    schur: Array

    def solve(self, right: Array, held: Flags | None = None, at: Array | None = None) -> Array:
        """Solve for a right-hand side (size,) or several (size, count); the parameters `held` stay `at` given values.

        Raises:
            LinAlgError: the Schur complement of the parameters that are not held is not positive definite.
            ValueError: something is not finite.
        """
        count = len(self.schur)
        held = np.zeros(count, dtype=np.bool_) if held is None else held
        scale = self.scale if right.ndim == 1 else self.scale[:, None]
        scaled = right / scale
        states = np.asarray(cho_solve_banded((self.factor, True), scaled[count:]))
        reduced = scaled[:count] - self.carried.T @ scaled[count:]
        found = np.zeros_like(reduced)
        if at is not None:
            found[held] = (at * self.scale[:count])[held]
        rest = ~held
        if np.any(rest):
            reduced = reduced[rest] - self.schur[np.ix_(rest, held)] @ found[held]
            found[rest] = cho_solve(cho_factor(self.schur[np.ix_(rest, rest)]), reduced)
        solved: Array = np.concatenate([found, states - self.carried @ found]) / scale
        return solved

    def energy(self, right: Array) -> Array:
        """right' N^-1 right of several right-hand sides (size, count): (count, count).

        Raises:
            LinAlgError: the Schur complement is not positive definite.
        """
        count = len(self.schur)
        scaled = right / self.scale[:, None]
        reduced = scaled[:count] - self.carried.T @ scaled[count:]
        reduced = solve_triangular(cholesky(self.schur, lower=True), reduced, lower=True)
        _substitute(self.factor, scaled[count:])
        found: Array = reduced.T @ reduced + scaled[count:].T @ scaled[count:]
        return found

    def columns_of_parameters(self) -> Array:
        """The inverse's columns of the parameters."""
        count = len(self.schur)
        inner = np.linalg.pinv(self.schur, rcond=SINGULAR, hermitian=True)
        columns: Array = np.concatenate([inner, -self.carried @ inner]) / np.outer(self.scale, self.scale[:count])
        return columns


@compiled
def _substitute(factor: Array, right: Array) -> None:
    """Solve L x = right in place for a banded L, row by row for all right-hand sides; LAPACK does them one by one."""
    for row in range(len(right)):
        for other in range(max(0, row - len(factor) + 1), row):
            right[row] -= factor[row - other, other] * right[other]
        right[row] /= factor[0, row]


def _bands(matrix: NormalMatrix, scale: Array, damping: float) -> Array:
    """The states' part over outer(scale, scale), damped, in LAPACK's form of a lower banded matrix."""
    windows, size, _ = matrix.own.shape
    scale = scale.reshape(windows, size)
    own = matrix.own / (scale[:, :, None] * scale[:, None, :])
    following = matrix.following / (scale[:-1, :, None] * scale[1:, None, :])
    bands = np.zeros((2 * size, windows, size))
    for column in range(size):
        for row in range(column, size):
            bands[row - column, :, column] = own[:, row, column]
        for row in range(size):
            bands[size + row - column, :-1, column] = following[:, column, row]
    bands[0] += damping
    return bands.reshape(2 * size, windows * size)
