"""Coloured noise: the autocorrelation of its samples, and how that widens an interval.

Noise behind a first-order filter has the autocorrelation c exp(-lag / T), with c below one where white noise, as of a
converter, is added after the filter. Both numbers are estimated from the residual; a parameter's variance is then the
sum over all pairs of samples in place of single ones (P. J. Brockwell, R. A. Davis, Time Series: Theory and Methods,
Springer 1991, section 7.2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from eha_core.identification.numbers import Array

LAGS = 6
"""Lags whose decay gives the time constant."""
CERTAIN = 5.0
"""Autocorrelation, in standard deviations of a white residual's, from which a residual counts as coloured."""
LEAST = 0.1
"""Autocorrelation of neighbours from which it widens an interval by a tenth and more."""
LONGEST = 0.995
"""Largest decay factor per sample: time constants above 200 samples are a model's error, not noise."""


@dataclass(frozen=True)
class Colour:
    """The autocorrelation `share` * `kept`**lag, and 1 at lag 0; `kept` 0 is white."""

    share: float = 0.0
    kept: float = 0.0

    @property
    def slow(self) -> float:
        """Power at frequencies below the filter's corner, over that of white noise with the same variance."""
        return 1.0 + 2.0 * self.share * self.kept / (1.0 - self.kept)


WHITE = Colour()


def colour_of(residual: Array) -> Colour:
    """The colour of one channel's residual, given in the order of time."""
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
    """Variances (sums,) of weighted sums of noise with unit variance; `pulls` (n, sums) are the weights."""
    single = np.sum(pulls**2, axis=0)
    if not colour.kept:
        return np.asarray(single)
    before = lfilter([0.0, colour.kept], [1.0, -colour.kept], pulls, axis=0)
    return np.asarray(single + 2.0 * colour.share * np.sum(pulls * before, axis=0))
