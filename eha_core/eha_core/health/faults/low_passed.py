"""A low-pass filtered channel: its noise is not white, but falls towards the highest frequencies.

The noise of a sensor and of its converter is equally strong in both halves of the upper spectrum. A filter in the
amplifier or in an exporter reduces it, and delays the motion as well. The test is how the power falls from one quarter
of the spectrum to the next. Motion also makes a channel less white; therefore only a fall within the highest half
counts, where the motion of a sound channel has died away.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.signal import Signal
from eha_core.health.spectrum import usual_spectrum

FALLS = 0.87
"""Power in the highest quarter of the spectrum over that in the next, up to which it counts as falling: 0.72 behind a
filter with its corner at a tenth of the highest frequency and below."""
SURE = 3.0
"""Standard deviations by which it must fall; white noise never does that and has MUCH in the quarter below as well."""
STEEP = 2.0
"""Power at the start of the third quarter over that at its end: 1.5 behind such a filter. More is the end of motion."""
MUCH = (0.1, 0.5)
"""The power in the highest quarter over that in the second lowest: 0.3 behind such a filter. Less is motion."""


FEWEST = 30
"""Fewest segments of the median spectrum."""
EFFICIENCY = 0.6
"""Efficiency of a median over segments that overlap by half, compared with the mean of as many lines."""


def find(signal: Signal) -> Found | None:
    """The whole channel, where its noise falls."""
    if signal.is_command or not signal.is_noisy:
        return None
    share, power, count = usual_spectrum(signal)
    if count < FEWEST:
        return None

    def usual(low: float, width: float) -> float:
        return float(np.median(np.mean(power[:, (share > low) & (share <= low + width)], axis=1)))

    second, third, fourth = usual(0.25, 0.25), usual(0.5, 0.25), usual(0.75, 0.25)
    limit = 1.0 - SURE * np.sqrt(2.0 / (EFFICIENCY * count * len(share) / 4.0))
    is_motion = usual(0.5, 0.07) > STEEP * usual(0.68, 0.07)
    if fourth / third > min(FALLS, limit) or not MUCH[0] < fourth / second < MUCH[1] or is_motion:
        return None
    fault = Fault(
        signal.name, "low_passed", float(signal.time[0]), float(signal.time[-1]),
        "its noise falls towards high frequencies, as behind a low-pass filter",
        "record the sensor without a filter, or state it in the model as a lag", False,
    )  # fmt: skip
    return Found([fault], np.zeros(len(signal.channel.values), dtype=np.bool_))
