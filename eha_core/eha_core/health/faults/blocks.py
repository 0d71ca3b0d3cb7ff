"""A channel's noise block by block."""

from __future__ import annotations

from math import comb, sqrt

import numpy as np

from eha_core.health.noise import Integers, usual_sizes
from eha_core.health.signal import Signal
from eha_core.recording.recording import FloatArray

SECONDS, SAMPLES = 0.25, 60
"""A block has at least so many seconds and samples: its noise is then known to a tenth."""
ORDER = 4
"""Of the differences that show noise and not motion."""


def noise_by_block(signal: Signal) -> tuple[Integers, FloatArray]:
    """The first sample of each block, and the noise that each shows."""
    length = max(SAMPLES, round(SECONDS / signal.period))
    count = max(1, len(signal.values) // length)
    edges = np.linspace(0, len(signal.values), count + 1).astype(np.int64)
    rough = np.diff(signal.values, n=ORDER) / sqrt(comb(2 * ORDER, ORDER))
    return edges, usual_sizes([rough[first : last - ORDER] for first, last in zip(edges[:-1], edges[1:], strict=True)])
