"""A channel that was low-passed: its noise is not white, but falls towards the highest frequencies.

A sensor's own noise, and that of its converter, is as strong in one half of the upper spectrum as in the other. A
filter in the amplifier or in an exporter takes it away, and it delays the motion as well. Judged is how the power falls
from one quarter of the spectrum to the next; the motion that reaches so high makes a channel less white, so only what
falls in the highest half is certain, where a motion of a sound channel has died away.
"""

from __future__ import annotations

import numpy as np

from eha_core.health.fault import Fault, Found
from eha_core.health.signal import Signal
from eha_core.health.spectrum import spectrum

FALLS = 0.9
"""Power in the highest quarter of the spectrum over that in the next, from which on it falls."""
MUCH = 0.55
"""The same over that in the second lowest quarter."""
SURE = 5.0
"""Standard deviations by which it must fall: 3e-7 of sound channels."""


def find(signal: Signal) -> Found | None:
    """The whole channel, where its noise falls."""
    if signal.is_command or not signal.is_noisy:
        return None
    frequency, power = spectrum(signal)
    share = frequency * signal.period * 2.0
    quarters = [power[(share > low) & (share <= low + 0.24)] for low in (0.26, 0.5, 0.74)]
    second, third, fourth = (float(np.mean(part)) for part in quarters)
    # a Hanning window has two thirds of the lines' independence
    limit = 1.0 - SURE * np.sqrt(2.0 / (0.5 * len(quarters[2])))
    if fourth / third > min(FALLS, limit) or fourth / second > MUCH:
        return None
    corner = _corner(fourth / second, signal.period)
    fault = Fault(
        signal.name, "low_passed", float(signal.time[0]), float(signal.time[-1]),
        f"its noise falls towards high frequencies, as behind a filter of about {corner:.2g} Hz",
        "record the sensor without a filter, or state it in the model as a lag", False,
    )  # fmt: skip
    return Found([fault], np.zeros(len(signal.channel.values), dtype=np.bool_))


def _corner(ratio: float, period: float) -> float:
    """The corner frequency [Hz] of a first-order filter with so much power in the fourth quarter over the second."""
    kept = np.linspace(0.02, 0.999, 400)
    second, fourth = (1.0 / (1.0 + kept**2 - 2.0 * kept * np.cos(np.pi * share)) for share in (0.38, 0.86))
    return float(-np.log(kept[np.argmin(np.abs(fourth / second - ratio))]) / (2.0 * np.pi * period))
