"""Series prepared for plots: thinned without losing peaks, and tested for dependence on other variables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from eha_core.identification.numbers import Array

DRAWN = 3000
"""Most points of one curve: about two for each pixel of a wide screen."""

DOTTED = 2500
"""Most points of one cloud."""


def thinned(time: Array, values: Array, most: int = DRAWN) -> tuple[Array, Array]:
    """At most about `most` points: the least and the greatest value of each bucket of time, in their order."""
    count = len(values)
    if count <= most:
        return time, values
    width = -(-count // (most // 2))
    buckets = np.pad(values, (0, -count % width), mode="edge").reshape(-1, width)
    extremes = np.column_stack([buckets.argmin(axis=1), buckets.argmax(axis=1)])
    # what was padded repeats the last sample
    kept = np.unique(np.minimum(extremes + width * np.arange(len(buckets))[:, None], count - 1))
    return time[kept], values[kept]


def pieces(time: Array, values: Array, spans: Iterable[tuple[float, float]], most: int = DRAWN) -> tuple[Array, Array]:
    """The parts inside the intervals, thinned, with a NaN between them so that no line joins them."""
    found = [slice(*np.searchsorted(time, span)) for span in spans]
    budget = max(20, most // max(len(found), 1))
    times, parts = [], []
    for inside in found:
        if inside.stop > inside.start:
            x, y = thinned(time[inside], values[inside], budget)
            times.append(np.append(x, x[-1]))
            parts.append(np.append(y, np.nan))
    return (np.concatenate(times), np.concatenate(parts)) if times else (np.empty(0), np.empty(0))


def spread(*columns: Array, most: int = DOTTED) -> tuple[Array, ...]:
    """Evenly chosen rows of columns of one length."""
    rows = np.unique(np.linspace(0, len(columns[0]) - 1, min(most, len(columns[0]))).astype(np.int64))
    return tuple(column[rows] for column in columns)


@dataclass(frozen=True)
class Dependence:
    """How a residual depends on a variable: its `means` over it, and the share of its variance that they explain."""

    variable: str
    at: Array
    share: float
    centres: Array
    means: Array


def strongest_dependence(
    time: Array, residual: Array, variables: Mapping[str, Array], most_bins: int = 24
) -> Dependence | None:
    """The variable whose bins of equal count explain most of the residual; None without any variable.

    The share is an adjusted R^2: it is corrected for what as many bins explain of pure noise.
    """
    found = []
    bins = min(most_bins, max(4, len(time) // 25))
    for name, values in variables.items():
        if name == "time":
            continue
        at = np.interp(time, variables["time"], values)
        edges = np.unique(np.quantile(at, np.linspace(0.0, 1.0, bins + 1)))
        if len(edges) < 3:
            continue
        place = np.clip(np.searchsorted(edges, at, side="right") - 1, 0, len(edges) - 2)
        counts = np.bincount(place, minlength=len(edges) - 1)
        filled = np.maximum(counts, 1)
        means = np.bincount(place, weights=residual, minlength=len(edges) - 1) / filled
        centres = np.bincount(place, weights=at, minlength=len(edges) - 1) / filled
        total = float(np.sum((residual - residual.mean()) ** 2)) or 1.0
        share = float(np.sum(counts * (means - residual.mean()) ** 2)) / total
        share = max(0.0, 1.0 - (1.0 - share) * (len(time) - 1) / max(len(time) - len(counts), 1))
        found.append(Dependence(name, at, share, centres[counts > 0], means[counts > 0]))
    return max(found, key=lambda dependence: dependence.share, default=None)


def autocorrelation(time: Array, residual: Array, lags: int) -> tuple[Array, Array]:
    """Autocorrelation of a residual at up to `lags` sampling periods; missing samples are skipped.

    Returns the lags [s] from one period on, and the correlations.
    """
    period = float(np.median(np.diff(time)))
    place = np.round((time - time[0]) / period).astype(np.int64)
    grid, there = np.zeros(place[-1] + 1), np.zeros(place[-1] + 1)
    grid[place], there[place] = residual - residual.mean(), 1.0
    lags = min(lags, len(grid) - 2)
    power = float(grid @ grid) / float(there.sum()) or 1.0
    found = [
        float(grid[:-lag] @ grid[lag:]) / max(float(there[:-lag] @ there[lag:]), 1.0) / power
        for lag in range(1, lags + 1)
    ]
    return np.arange(1, lags + 1, dtype=np.float64) * period, np.array(found, dtype=np.float64)
