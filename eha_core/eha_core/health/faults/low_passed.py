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
from eha_core.health.spectrum import INDEPENDENT, spectrum

FALLS = 0.87
"""Power in the highest quarter of the spectrum over that in the next, up to which it falls: 0.72 behind a filter of a
tenth of the highest frequency and less."""
SURE = 3.0
"""Standard deviations by which it must fall; that, and MUCH in the quarter below, no white noise does."""
STEEP = 1.9
"""Power at the start of the third quarter over that at its end: 1.5 behind such a filter. More is motion that ends."""
MUCH = (0.1, 0.5)
"""The power in the highest quarter over that in the second lowest: 0.3 behind such a filter. Less is motion."""


def find(signal: Signal) -> Found | None:
    """The whole channel, where its noise falls."""
    if signal.is_command or not signal.is_noisy:
        return None
    frequency, power = spectrum(signal)
    share = frequency * signal.period * 2.0
    quarters = [power[(share > low) & (share <= low + 0.24)] for low in (0.26, 0.5, 0.74)]
    second, third, fourth = (float(np.mean(part)) for part in quarters)
    begins, ends = (float(np.mean(power[(share > low) & (share <= low + 0.06)])) for low in (0.5, 0.68))
    limit = 1.0 - SURE * np.sqrt(2.0 / (INDEPENDENT * len(quarters[2])))
    if fourth / third > min(FALLS, limit) or not MUCH[0] < fourth / second < MUCH[1] or begins > STEEP * ends:
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
