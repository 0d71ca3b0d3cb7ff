"""The test function of the weak form: a smooth weight in time that is zero with its slope at both ends.

An equation is multiplied by it and integrated; by parts, derivatives fall on the weight, and no measured channel is
differentiated. After D. A. Messenger and D. M. Bortz, "Weak SINDy", Multiscale Modeling & Simulation 19 (2021).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF_WIDTH = 0.06
"""s; wide enough to average noise, narrow compared with a reversal's duration."""

FEWEST = 8
"""Fewest samples on either side of the centre."""


class Weighting(NamedTuple):
    """(1 - s^2)^4 over s from -1 to 1, sampled at 2 half + 1 instants, with its first two derivatives in time [1/s,
    1/s^2]."""

    weight: Array
    slope: Array
    curvature: Array


def weighting(step: float, half_width: float = HALF_WIDTH) -> Weighting:
    """The test function of `half_width` [s], sampled every `step` [s]."""
    half = max(FEWEST, round(half_width / step))
    at = np.arange(-half, half + 1) / half
    inside, width = 1.0 - at**2, half * step
    curvature = (48.0 * at**2 * inside**2 - 8.0 * inside**3) / width**2
    return Weighting(inside**4, -8.0 * at * inside**3 / width, curvature)
