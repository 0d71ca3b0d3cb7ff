"""Least squares over several steps whose scatter is their own noise and what differs from step to step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

from eha_core.step_tests.result import Array, Estimate

SIGNIFICANT = 0.01
"""Probability of chance below which a further term is there (assumed)."""


@dataclass(frozen=True)
class Line:
    """Fitted values and their covariance; `weights` are inverse variances of the points, `freedom` what is left."""

    values: Array
    covariance: Array
    weights: Array
    freedom: int

    def of(self, value: float, slopes: Sequence[float]) -> Estimate:
        """A quantity that changes with the values by these slopes."""
        along = np.asarray(slopes)
        deviation = float(np.sqrt(max(along @ self.covariance @ along, 0.0)))
        return Estimate(float(value), float(student.ppf(0.975, max(self.freedom, 1))) * deviation)

    def estimate(self, place: int) -> Estimate:
        """One of the values."""
        return self.of(float(self.values[place]), np.eye(self.values.size)[place].tolist())

    def chance(self, place: int) -> float:
        """Probability that a value that is zero is found as far from it."""
        if self.freedom < 1 or not self.covariance[place, place] > 0.0:
            return 1.0
        ratio = abs(self.values[place]) / self.covariance[place, place] ** 0.5
        return float(2.0 * student.sf(ratio, self.freedom))


def fit_line(columns: Sequence[Array], points: Sequence[Estimate]) -> Line:
    """Fit points by columns, with a scatter between steps that makes the residuals as large as they are expected.

    Args:
        columns: of the linear law, each (n,).
        points: the n points with their own intervals.
    """
    design = np.column_stack(columns)
    values = np.array([point.value for point in points])
    own = np.array([point.deviation for point in points]) ** 2
    freedom = values.size - design.shape[1]
    floor = max(1e-12 * float(np.max(np.abs(values))) ** 2, 1e-30)

    def solved(scatter: float) -> tuple[Array, Array, Array]:
        weights = 1.0 / np.maximum(own + scatter, floor)
        covariance = np.asarray(np.linalg.pinv(design.T @ (design * weights[:, None])), dtype=np.float64)
        solution: Array = covariance @ (design.T @ (weights * values))
        return solution, covariance, weights

    def excess(scatter: float) -> float:
        found, _, weights = solved(scatter)
        return float(weights @ (values - design @ found) ** 2) - freedom

    scatter, most = 0.0, 10.0 * float(np.var(values)) + floor
    if freedom > 0 and excess(0.0) > 0.0 > excess(most):
        scatter = float(brentq(excess, 0.0, most))
    found, covariance, weights = solved(scatter)
    return Line(found, covariance, weights, freedom)


def mean_of(points: Sequence[Estimate]) -> Estimate:
    """The mean of points; of one, the point itself."""
    return points[0] if len(points) == 1 else fit_line([np.ones(len(points))], points).estimate(0)
