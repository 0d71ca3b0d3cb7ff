"""Whether the nominal model fails over one span only, and is at the noise at all other times.

What is missing from a model is missing whenever the piston moves as it did before. What happens once is an event on the
rig, as a load that touches or a valve that is opened, or a fault of the recording; a law for it would be of that span
alone. Where a channel's noise is known too large, as behind a filter, a model may fail at all times and yet be at the
noise; what was found then explains more at other times, too.
"""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.criteria import ENOUGH, NEARLY_ALL, UNFITTED
from eha_core.identification.fit import Fit
from eha_core.identification.shooting import Shooting

FEWEST = 6
"""Windows of a recording from which on one of them can be an exception."""
MOST = 0.34
"""Share of the windows that an event takes at most; of more it is not sure which is the exception (assumed)."""
LOUD = 2.0
"""Chi^2 a sample of a window that the nominal model fails in: of a window's hundreds of samples noise leaves one, give
or take a tenth. Windows between this and UNFITTED may belong to the event at its edges."""


def event(shooting: Shooting, nominal: Fit, winner: Fit) -> tuple[float, float] | None:
    """From when until when [s] the nominal model fails, if in all other windows of the recording it is at the noise and
    what was found explains no more."""
    if shooting.windows < FEWEST:
        return None
    left, gained = np.zeros(shooting.windows), np.zeros(shooting.windows)
    for sampling, residual, after in zip(shooting.samplings, nominal.residuals, winner.residuals, strict=True):
        counts = np.bincount(sampling.window, minlength=shooting.windows)
        squares = np.bincount(sampling.window, weights=residual**2, minlength=shooting.windows)
        left = np.maximum(left, squares / np.maximum(counts, 1))
        gained += np.bincount(sampling.window, weights=residual**2 - after**2, minlength=shooting.windows)
    loud, above = np.flatnonzero(left > LOUD), np.flatnonzero(left > UNFITTED)
    if not len(loud):
        return None
    first, last = int(above[0]), int(above[-1])
    if last - first + 1 > MOST * shooting.windows or first < loud[0] - 1 or last > loud[-1] + 1:
        return None
    inside = float(np.sum(gained[first : last + 1]))
    elsewhere = float(np.sum(gained)) - inside
    if elsewhere > max(ENOUGH, NEARLY_ALL * inside):
        return None
    begin, end = shooting.edges[first], shooting.edges[last + 1]
    return float(begin) * shooting.step_size, float(end) * shooting.step_size
