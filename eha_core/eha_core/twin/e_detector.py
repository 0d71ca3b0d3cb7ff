"""Evidence that residuals have left their noise, weighed anew with each window and valid whenever it is looked at.

For each window the likelihood that the residual is larger than allowed is held against that of the largest that is
allowed. Such a ratio has a mean of at most one while the model holds (an e-value). Summed and multiplied from window to
window it is an e-detector of Shiryaev and Roberts' form: until it exceeds c by chance, c windows pass in the mean.
After J. Shin, A. Ramdas and A. Rinaldo, "E-detectors", New England Journal of Statistics in Data Science 2 (2024).
"""

from __future__ import annotations

import numpy as np

from eha_core.twin.samples import Array

TIMES_LARGER = (1.5, 2.0, 4.0, 8.0)
"""Sizes that a residual may have taken, in units of the largest allowed; each as likely as the other (assumed)."""

CLIPPED = 6.0
"""A value counts as so many times the largest allowed at most: a single one, such as a spike's, is no alarm."""


def log_e_value(values: Array, allowed: float) -> Array:
    """The logarithm of a window's e-value: of (..., n) normal values, independent of each other, whose standard
    deviation is at most `allowed`, its exponential has a mean of one or less."""
    squared = np.sum(np.minimum(np.abs(values) / allowed, CLIPPED) ** 2, axis=-1)[..., None]
    larger = np.array(TIMES_LARGER)
    ratios = 0.5 * squared * (1.0 - larger**-2) - values.shape[-1] * np.log(larger)
    return np.asarray(np.logaddexp.reduce(ratios, axis=-1) - np.log(len(larger)))


class Detector:
    """The evidence so far that a residual is larger than allowed; an alarm where it reaches `windows`, the mean number
    of windows until that happens by chance. `evidence` and what is `needed` are natural logarithms."""

    def __init__(self, windows: float) -> None:
        self.needed = float(np.log(windows))
        self.evidence = -np.inf

    @property
    def is_alarmed(self) -> bool:
        """Whether there is enough."""
        return self.evidence >= self.needed

    @property
    def is_suspicious(self) -> bool:
        """Whether there is more than the next window brings by chance."""
        return self.evidence > 0.0

    def weigh(self, log_e: float) -> None:
        """Take a window's e-value. More than enough is not kept: a rig may follow the model again."""
        self.evidence = min(log_e + float(np.logaddexp(0.0, self.evidence)), self.needed)
