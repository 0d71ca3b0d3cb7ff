"""Stage 4d, attribute: the sites by the share of what is unexplained that their best hypothesis takes away.

Where and when the nominal equations fail is `locate`'s; which site it is follows from the names that were tried.
"""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.locate import whereabouts
from eha_core.diagnosis.result import Location
from eha_core.diagnosis.search.model_comparison import ModelComparison
from eha_core.identification.fit import Fit


def attribute(
    calibration: Calibration,
    nominal: Fit,
    scales: Scales,
    comparison: ModelComparison,
    recording: int = 1,
) -> tuple[Location, ...]:
    """The sites by the share of the unexplained chi^2 that their best hypothesis takes away, the largest first.

    Where in state space and when is told of one `recording`, counted from one.
    """
    shooting = calibration.shooting
    unexplained = max(nominal.objective - nominal.count, 1.0)
    gains = _site_gains(comparison)
    where, when = whereabouts(shooting, nominal, scales, recording)
    found: list[Location] = []
    for site, gain in sorted(gains.items(), key=lambda item: -item[1])[:4]:
        share = float(np.clip(gain / unexplained, 0.0, 1.0))
        if share < 0.01 and found:
            continue
        found.append(Location(site, share, where, when))
    return tuple(found)


def _site_gains(comparison: ModelComparison) -> dict[str, float]:
    """The refitted gain of each site's best hypothesis, or else the predicted one, which never counts as much."""
    gains: dict[str, float] = {}
    nominal = comparison.nominal.fit
    refitted: dict[str, float] = {}
    for entry in comparison.entries:  # an effect may be among them twice: acting always, and for a while
        if len(entry.ids) == 1:
            gain = nominal.objective - entry.fit.objective
            refitted[entry.ids[0]] = max(gain, refitted.get(entry.ids[0], gain))
    most = max([0.0, *refitted.values()])
    for score_test in comparison.score_tests:
        effect = score_test.guess.effect
        gain = refitted.get(effect.id, min(score_test.gain, 0.5 * most))
        if gain > gains.get(effect.site, 0.0):
            gains[effect.site] = gain
    return gains
