"""Whether the nominal model fails in one interval only, and is at the noise level at all other times.

Missing physics acts whenever the same motion recurs. What happens once is an event on the rig, such as contact with a
load or the opening of a valve, or a fault of the recording; a law fitted to it would hold in that interval alone. Where
a channel's noise level is too high, as behind a filter, a wrong model may stay at the noise throughout; the effects
found then improve the fit at other times, too.
"""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.criteria import ENOUGH, ENOUGH_WINDOWS, LOUD_WINDOW, MOST_OF_AN_EVENT, NEARLY_ALL, UNFITTED
from eha_core.identification.fit import Fit
from eha_core.identification.shooting import Shooting


def event(shooting: Shooting, nominal: Fit, winner: Fit) -> tuple[float, float] | None:
    """The interval [s] in which the nominal model fails; None unless it is at the noise in all other windows and the
    effects found do not improve the fit there."""
    if shooting.windows < ENOUGH_WINDOWS:
        return None
    left, gained = np.zeros(shooting.windows), np.zeros(shooting.windows)
    for sampling, residual, after in zip(shooting.samplings, nominal.residuals, winner.residuals, strict=True):
        counts = np.bincount(sampling.window, minlength=shooting.windows)
        squares = np.bincount(sampling.window, weights=residual**2, minlength=shooting.windows)
        left = np.maximum(left, squares / np.maximum(counts, 1))
        gained += np.bincount(sampling.window, weights=residual**2 - after**2, minlength=shooting.windows)
    loud, above = np.flatnonzero(left > LOUD_WINDOW), np.flatnonzero(left > UNFITTED)
    if not len(loud):
        return None
    first, last = int(above[0]), int(above[-1])
    if last - first + 1 > MOST_OF_AN_EVENT * shooting.windows or first < loud[0] - 1 or last > loud[-1] + 1:
        return None
    inside = float(np.sum(gained[first : last + 1]))
    elsewhere = float(np.sum(gained)) - inside
    if elsewhere > max(ENOUGH, NEARLY_ALL * inside):
        return None
    begin, end = shooting.edges[first], shooting.edges[last + 1]
    return float(begin) * shooting.step_size, float(end) * shooting.step_size
