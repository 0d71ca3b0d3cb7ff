"""Noise with a memory: how its samples depend on each other, and what that adds to an interval.

Behind a filter of first order noise has the autocorrelation c exp(-lag / T), less than one at once where white noise,
as of a converter, comes after it. Both numbers are estimated from the residual; a parameter's variance is then the sum
over all pairs of samples, in place of that over single ones (P. J. Brockwell, R. A. Davis, Time Series: Theory and
Methods, Springer 1991, section 7.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from eha_core.identification.numbers import Array

LAGS = 6
"""Lags by whose decay the memory is estimated."""
CERTAIN = 5.0
"""Standard deviations of a white residual's autocorrelation from which on a residual has a memory."""
LEAST = 0.1
"""Autocorrelation of neighbours from which on a memory widens an interval by a tenth and more."""
LONGEST = 0.995
"""Of one sample by the one before: longer memories than of 200 samples are a model's error and no noise's."""


@dataclass(frozen=True)
class Colour:
    """Autocorrelation `share` times `kept` to the power of the lag, and one at none; `kept` 0 is white."""

    share: float = 0.0
    kept: float = 0.0

    @property
    def slow(self) -> float:
        """Power at frequencies below the filter's corner, over that of white noise of the same size."""
        return 1.0 + 2.0 * self.share * self.kept / (1.0 - self.kept)


WHITE = Colour()


def colour_of(residual: Array) -> Colour:
    """The memory of one channel's residual, in the order of time."""
    if len(residual) < 10 * LAGS:
        return WHITE
    centred = residual - residual.mean()
    power = float(centred @ centred)
    if not power > 0.0:
        return WHITE
    lagged = np.array([float(centred[:-lag] @ centred[lag:]) for lag in range(1, LAGS + 1)]) / power
    if lagged[0] < max(LEAST, CERTAIN / np.sqrt(len(residual))):
        return WHITE
    kept = float(np.clip(lagged[:-1] @ lagged[1:] / (lagged[:-1] @ lagged[:-1]), 0.0, LONGEST))
    if not kept > 0.0:
        return WHITE
    return Colour(min(1.0, float(lagged[0]) / kept), kept)


def spread(pulls: Array, colour: Colour) -> Array:
    """Variance of sums of noise of unit variance: `pulls` (n, sums) is how much of each sample a sum takes."""
    single = np.sum(pulls**2, axis=0)
    if not colour.kept:
        return np.asarray(single)
    before = lfilter([0.0, colour.kept], [1.0, -colour.kept], pulls, axis=0)
    return np.asarray(single + 2.0 * colour.share * np.sum(pulls * before, axis=0))
