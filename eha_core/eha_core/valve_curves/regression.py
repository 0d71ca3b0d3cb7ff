"""Least squares with intervals that hold where neighbouring residuals are alike, and the choice between laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from eha_core.valve_curves.result import Array

DECISIVE = 10.0
"""Difference of the Bayesian information criterion from which a law with more terms is taken: "very strong" evidence
(R. E. Kass, A. E. Raftery, Bayes Factors, Journal of the American Statistical Association 90, 1995)."""

RESOLUTION = 1e-4
"""Share of the largest response below which no valve bench resolves it; residuals smaller than that count as this
large (assumed)."""

MOST_ALIKE = 0.999
"""Largest correlation of neighbouring residuals that is reckoned with: one in 2,000 points then counts (assumed)."""

MOST_STEPS = 50
"""Most steps of a fit: laws that suit a curve take about ten; those with a term too many do not end (assumed)."""


@dataclass(frozen=True)
class Regression:
    """A law that was fitted.

    Attributes:
        values: the law's values.
        covariance: their covariance.
        residual: law minus response at each point.
        effective: number of points that the correlation of neighbouring residuals leaves independent.
        deviation: standard deviation of the residual.
    """

    values: Array
    covariance: Array
    residual: Array
    effective: float
    deviation: float

    def reach(self, slopes: Array) -> float:
        """Half of the 95 % interval of a quantity that changes with the values by these slopes."""
        freedom = max(self.effective - self.values.size, 1.0)
        variance = float(slopes @ self.covariance @ slopes)
        return float(student.ppf(0.975, freedom) * np.sqrt(max(variance, 0.0)))

    def of(self, quantity: Callable[[Array], float]) -> tuple[float, float]:
        """A quantity that follows from the values, and half of its 95 % interval."""
        return float(quantity(self.values)), self.reach(_slopes(quantity, self.values))


def regress(
    law: Callable[[Array], Array],
    response: Array,
    start: Sequence[float],
    lower: Sequence[float] | None = None,
    upper: Sequence[float] | None = None,
) -> Regression:
    """Fit a law of values of about one to a response of about one.

    Args:
        law: the response at all points by the values.
        response: as measured, in the order of measuring.
        start: initial values.
        lower, upper: bounds of the values; by default none.
    """
    bounds = (np.full(len(start), -np.inf) if lower is None else np.asarray(lower, dtype=float),
              np.full(len(start), np.inf) if upper is None else np.asarray(upper, dtype=float))  # fmt: skip
    found = least_squares(
        lambda values: law(values) - response, np.clip(start, *bounds), bounds=bounds, max_nfev=MOST_STEPS
    )
    residual: Array = found.fun
    alike = float(np.clip(_neighbours(residual), 0.0, MOST_ALIKE))
    effective = response.size * (1.0 - alike) / (1.0 + alike)
    floor = (RESOLUTION * float(np.max(np.abs(response)))) ** 2
    variance = max(float(residual @ residual) / max(response.size - len(start), 1), floor)
    spread = variance * response.size / effective
    return Regression(found.x, spread * np.linalg.pinv(found.jac.T @ found.jac), residual, effective, variance**0.5)


def criterion_gain(simple: Regression, larger: Regression) -> float:
    """By how much the Bayesian information criterion prefers the larger of two laws of the same points."""
    more = larger.values.size - simple.values.size
    return larger.effective * 2.0 * log(simple.deviation / larger.deviation) - more * log(larger.residual.size)


def explained(regression: Regression, response: Array) -> float:
    """Share of the response's variance that a law explains."""
    return 1.0 - float(np.var(regression.residual)) / float(np.var(response))


def _neighbours(residual: Array) -> float:
    """Correlation of each residual with the next."""
    power = float(residual @ residual)
    return float(residual[1:] @ residual[:-1]) / power if power > 0.0 else 0.0


def _slopes(quantity: Callable[[Array], float], values: Array) -> Array:
    """Central differences."""
    slopes = np.empty(values.size)
    for k in range(values.size):
        step = np.zeros(values.size)
        step[k] = 1e-5 * max(abs(values[k]), 1e-3)
        slopes[k] = (quantity(values + step) - quantity(values - step)) / (2.0 * step[k])
    return slopes
