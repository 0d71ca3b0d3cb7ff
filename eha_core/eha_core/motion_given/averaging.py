"""Whether a recorded signal went through a moving average, from the zeros that such a filter leaves in its spectrum.

The mean over w samples has zeros at all multiples of 1/w of the sampling rate, whatever the signal is. Hysteresis,
compliance, inertia and delays have none there. In the cepstrum, the inverse transform of the logarithm of the spectrum,
the zeros are a spike of -1 at w samples, of -1/2 at 2 w, of -1/3 at 3 w (A. V. Oppenheim, R. W. Schafer, "From
frequency to quefrency: a history of the cepstrum", IEEE Signal Processing Magazine 21, 2004). So one recording is
enough, and its motion need not be periodic.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eha_core.health.noise import ROUNDING

Array = NDArray[np.float64]

SPIKE = 0.6
"""Depth of the cepstrum at the window from which on the zeros are there: an average leaves 1, and 0.87 to 1.05 was
measured where one is known; recordings without one reach 0.42. Noise from after the average fills the zeros."""

SECOND = 0.2
"""The same at twice the window, where an average leaves 0.5; the half period of a motion leaves a ridge there."""

ALONE = 0.5
"""Share of the spike that the cepstrum may reach between half and one and a half windows: a steep low-pass filter
has several values in a row, an average has one."""

SHORTEST = 5
"""Samples of the shortest window that is looked for; a sensor's own filter is as short."""

LONGEST = 0.1
"""Share of the recording of the longest window that is looked for, so that the signal has ten of it."""


def averaging_window(values: Array) -> int | None:
    """The samples over which evenly sampled values were averaged; None where no moving average shows.

    That none shows does not exclude one: rounding or noise added afterwards hides it.
    """
    # the second difference leaves noise and corners, and little of a slow motion that would hide the zeros
    rough = np.diff(values, 2)
    if not np.ptp(rough) > ROUNDING * np.ptp(values):
        return None
    rough = (rough - rough.mean()) * np.hanning(len(rough))
    spectrum = np.abs(np.fft.rfft(rough)) ** 2
    cepstrum = np.fft.irfft(np.log(np.maximum(spectrum, 1e-30 * spectrum.max())))
    end = int(LONGEST * len(values))
    if end <= SHORTEST:
        return None
    window = SHORTEST + int(np.argmin(cepstrum[SHORTEST:end]))
    depth = -float(cepstrum[window])
    around = np.arange(window // 2 + 1, 3 * window // 2 + 1)
    others = -float(np.min(cepstrum[around[np.abs(around - window) > 1]]))
    if depth < SPIKE or -float(cepstrum[2 * window]) < SECOND or others > ALONE * depth:
        return None
    return window
