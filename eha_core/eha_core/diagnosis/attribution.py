"""Stage 4d, attribute: the sites, by the share of the unexplained chi^2 that their best hypothesis removes.

`locate` finds where and when the nominal equations fail; the site follows from the hypotheses that were tried.
"""

from __future__ import annotations

import numpy as np

from eha_core.diagnosis.calibrate import Calibration
from eha_core.diagnosis.characteristic_scales import Scales
from eha_core.diagnosis.locate import whereabouts
from eha_core.diagnosis.result import Location
from eha_core.diagnosis.search.comparison import ModelComparison
from eha_core.identification.fit import Fit


def attribute(
    calibration: Calibration,
    nominal: Fit,
    scales: Scales,
    comparison: ModelComparison,
    recording: int = 1,
) -> tuple[Location, ...]:
    """The sites by the share of the unexplained chi^2 that their best hypothesis removes, the largest first.

    The states and times of the failure are those of one `recording`, counted from one.
    """
    shooting = calibration.shooting
    unexplained = max(nominal.objective - nominal.count, 1.0)
    gains = comparison.site_gains
    where, when = whereabouts(shooting, nominal, scales, recording)
    found: list[Location] = []
    for site, gain in sorted(gains.items(), key=lambda item: -item[1])[:4]:
        share = float(np.clip(gain / unexplained, 0.0, 1.0))
        if share < 0.01 and found:
            continue
        found.append(Location(site, share, where, when))
    return tuple(found)
