"""A channel's noise level and quantisation step, from the channel alone."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, e, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, median_filter

from eha_core.recording.recording import FloatArray as Array

Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]

NORMAL_MEDIAN = 0.6744897501960817
"""The median of |z| for a standard normal z."""

NORMAL_MINIMUM = 1.0 - sqrt(2.0 / (pi * e))
"""The mean of min(z^2, 1) for a standard normal z."""

ROUNDING = 1e-9
"""Share of a channel's size below which two values are the same level, apart from double precision's rounding."""
ON_GRID = 0.1
"""Distance from a level, in steps, up to which a value counts as on it; without a grid, one value in five does."""
SHARE_ON_GRID = 0.95
"""Share of the values that must be on the grid; the others may be interpolated or outliers."""
NEARBY = np.abs(np.arange(-6, 7)) > 1
"""The samples about an outlier, from the second to the sixth on either side, that it must not affect."""


def estimate_noise(values: Array, order: int = 4, blocks: int = 20) -> float:
    """Standard deviation of white noise on a smooth signal.

    Differences of the given order remove the signal where it is smooth; the lower quartile over blocks of the record
    ignores the parts where it is not. Never below the noise of quantisation.
    """
    differences = np.diff(values, n=order)
    pieces = np.array_split(differences, max(1, min(blocks, len(differences) // 50)))
    deviations = usual_sizes([piece for piece in pieces if len(piece)]) / sqrt(comb(2 * order, order))
    estimate = float(np.quantile(deviations, 0.35)) if len(deviations) else 0.0
    return max(estimate, quantisation(values) / sqrt(12.0), 1e-12 * float(np.max(np.abs(values)) or 1.0))


def residual_noise(residual: Array, order: int = 2) -> float:
    """Standard deviation of the white part of a fit's residual, whatever the slow part from a wrong model."""
    return usual_size(np.diff(residual, n=order)) / sqrt(comb(2 * order, order))


def block_means(values: Array, size: int) -> Array:
    """(n // size, ...) means over successive blocks of `size` of (n, ...) values; an incomplete block is left out."""
    blocks = len(values) // size
    return np.asarray(values[: blocks * size].reshape(blocks, size, *values.shape[1:]).mean(axis=1))


def usual_size(values: Array) -> float:
    """Robust standard deviation of normal values about zero, of which up to half may be outliers.

    The s at which min((value / s)^2, 1) has the mean of a normal variable (Huber, Robust Statistics, 1981, section
    5.2). The median is as robust, but for values on a grid it is a grid value: 9 % off where the noise is two steps of
    an analogue-to-digital converter.
    """
    return float(usual_sizes([values])[0])


def usual_sizes(pieces: Sequence[Array]) -> Array:
    """`usual_size` of each piece, all of them at once."""
    if not pieces:
        return np.zeros(0)
    counts = np.array([len(piece) for piece in pieces])
    square = np.full((len(pieces), int(counts.max())), np.inf)
    for row, piece in zip(square, pieces, strict=True):
        row[: len(piece)] = piece**2
    ordered, rows = np.sort(square, axis=1), np.arange(len(pieces))
    middle = 0.5 * (ordered[rows, (counts - 1) // 2] + ordered[rows, counts // 2])
    square[np.isinf(square)] = 0.0
    variance = middle / NORMAL_MEDIAN**2
    # a piece that is mostly zero has size zero
    going_on = np.flatnonzero(variance > 0.0)
    for _ in range(50):
        if not len(going_on):
            break
        before = variance[going_on]
        within = np.minimum(square[going_on] / before[:, None], 1.0).sum(axis=1) / counts[going_on]
        variance[going_on] = before * within / NORMAL_MINIMUM
        going_on = going_on[np.abs(variance[going_on] / before - 1.0) >= 1e-6]
    return np.asarray(np.sqrt(variance), dtype=np.float64)


def quantisation(values: Array) -> float:
    """The step of a quantised channel, or 0 where its values are not on a grid.

    A fine encoder's values are all multiples of one step, however many levels a recording has; the differences between
    another channel's values have no common divisor.
    """
    distinct = np.unique(values)
    steps = np.diff(distinct)
    steps = steps[steps > ROUNDING * float(np.max(np.abs(values)))] if len(steps) else steps
    if len(steps) < 2:
        return 0.0
    least = float(np.quantile(steps, 0.05, method="lower"))  # a few values may be between the levels
    # One step has the rounding error of two values; the sum of many has hardly more.
    whole = np.round(steps / least)
    usual = (whole > 0.0) & (np.abs(steps / least - whole) < ON_GRID)
    step = float(np.sum(steps[usual])) / float(np.sum(whole[usual]))
    levels = (values - values[0]) / step
    # the grid's offset: the median of an even number of values, or any one value, may be between two levels
    place = float(np.angle(np.mean(np.exp(2j * pi * levels)))) / (2.0 * pi)
    off = np.abs(levels - place - np.round(levels - place))
    return step if float(np.mean(off < ON_GRID)) > SHARE_ON_GRID else 0.0


def find_outliers(values: Array, noise: float, limit: float = 8.0, width: int = 51) -> Flags:
    """Flags of single samples, and of two in a row, that differ from those around them by `limit` times the noise and
    the roughness nearby.

    At a step of the signal the samples on either side differ from each other, and where it rings, other samples are as
    rough. That is judged without the outliers themselves: two that are close together are not ringing.
    """
    usual = median_filter(_from_neighbours(values), size=width, mode="nearest")
    found, surprise = np.zeros(len(values), dtype=np.bool_), np.zeros(len(values))
    for count in (1, 2):
        off, step = _off(_without(found, values), count)
        far = (off > limit * np.maximum(noise, usual[: len(off)])) & (step < 0.25 * off)
        for place in np.flatnonzero(far):
            run = slice(place, place + count)
            found[run], surprise[run] = True, np.maximum(surprise[run], off[place])
    while found.any():
        rough = maximum_filter(_from_neighbours(_without(found, values)), footprint=NEARBY, mode="constant")
        alone = rough[found] < 0.3 * surprise[found]
        if alone.all():
            break
        found[found] = alone
    return np.asarray(found)


def _without(outliers: Flags, values: Array) -> Array:
    """The values with a line through the others in place of the outliers."""
    places = np.arange(len(values))
    return np.where(outliers, np.interp(places, places[~outliers], values[~outliers]), values)


def _from_neighbours(values: Array) -> Array:
    """How far each sample is from the mean of its neighbours."""
    return _off(values, 1)[0]


def _off(values: Array, count: int) -> tuple[Array, Array]:
    """How far `count` samples in a row are at least from the line between the samples on either side, and how far these
    differ; per first sample. At an end, the only sample beside them stands for both."""
    padded = np.concatenate([values[count : count + 1], values, values[-count - 1 : -count]])
    before, after = padded[: -count - 1], padded[count + 1 :]
    line = [before + (after - before) * place / (count + 1) for place in range(1, count + 1)]
    inside = [padded[place : len(padded) - count - 1 + place] for place in range(1, count + 1)]
    return np.min(np.abs(np.subtract(inside, line)), axis=0), np.abs(after - before)
