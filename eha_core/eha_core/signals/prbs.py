"""A pseudo-random binary sequence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eha_core.signals.signal import FloatArray, Signal, described, ticks

_TAPS = {
    3: (3, 2), 4: (4, 3), 5: (5, 3), 6: (6, 5), 7: (7, 6), 8: (8, 6, 5, 4), 9: (9, 5), 10: (10, 7), 11: (11, 9),
    12: (12, 11, 10, 4), 13: (13, 12, 11, 8), 14: (14, 13, 12, 2), 15: (15, 14), 16: (16, 15, 13, 4),
}  # fmt: skip
"""Feedback taps of primitive polynomials over GF(2), by register length."""


@dataclass(frozen=True)
class Prbs(Signal):
    """+amplitude or -amplitude for each dwell, by a shift register whose sequence repeats after 2^order - 1 dwells.

    Over a whole sequence its spectrum is flat up to about 0.4 / dwell.
    """

    amplitude: float = described(0.01, "height above and below the middle", "same")
    dwell: float = described(0.05, "shortest time between two changes", "s", 1e-4)
    order: int = described(9, "length of the shift register", "", min(_TAPS), max(_TAPS))
    seed: int = described(1, "where in the sequence it starts", "", 0, 2**31)

    @cached_property
    def _sequence(self) -> FloatArray:
        length = 2**self.order - 1
        register = 1
        bits = np.empty(length)
        for k in range(length):
            bits[k] = 1.0 if register & 1 else -1.0
            feedback = 0
            for tap in _TAPS[self.order]:
                feedback ^= register >> (self.order - tap)
            register = (register >> 1) | ((feedback & 1) << (self.order - 1))
        return np.roll(bits, -(self.seed % length))

    def shape(self, time: FloatArray) -> FloatArray:
        """The sequence."""
        place = np.mod(ticks(time, self.dwell), len(self._sequence))
        return np.asarray(self.amplitude * self._sequence[place])
