"""Correlation and least squares of columns."""

from __future__ import annotations

import numpy as np

from eha_core.recording.recording import FloatArray


def correlation(one: FloatArray, other: FloatArray) -> float:
    """Pearson's correlation; 0 where one of the two is constant."""
    one, other = one - one.mean(), other - other.mean()
    return float(one @ other / np.sqrt((one @ one) * (other @ other) + 1e-300))


def regression(values: FloatArray, *columns: FloatArray) -> tuple[FloatArray, float]:
    """Coefficients of the columns, and the share of the variance that they and a constant explain."""
    table = np.stack([*columns, np.ones(len(values))], axis=1)
    scale = np.max(np.abs(table), axis=0) + 1e-300
    solution = np.linalg.lstsq(table / scale, values, rcond=None)[0]
    rest = values - (table / scale) @ solution
    variance = float(np.sum((values - values.mean()) ** 2)) + 1e-300
    return solution / scale, 1.0 - float(rest @ rest) / variance


def explained_by(values: FloatArray, signal: FloatArray) -> float:
    """The share of the variance of `values` that a signal explains; 0 for a constant signal."""
    return regression(values, signal)[1] if np.ptp(signal) > 0.0 else 0.0


def fitted(values: FloatArray, *columns: FloatArray) -> FloatArray:
    """The least-squares fit of the values by the columns and a constant."""
    coefficients, _ = regression(values, *columns)
    return np.asarray(np.stack([*columns, np.ones(len(values))], axis=1) @ coefficients)
