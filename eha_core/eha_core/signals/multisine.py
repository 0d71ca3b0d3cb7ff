"""A sum of sines that excites many frequencies at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from random import Random

import numpy as np

from eha_core.errors import ParameterError
from eha_core.signals.signal import FloatArray, Signal, described

_GRID = 64  # points for each cycle of the highest frequency, to find the peak


@dataclass(frozen=True)
class Multisine(Signal):
    """`count` sines of equal height at multiples of 1 / `period`, spread evenly by factors, with seeded phases.

    Its largest magnitude over a period is the amplitude. Frequencies that fall on the same multiple count once.
    """

    amplitude: float = described(0.01, "largest magnitude", "same")
    lowest: float = described(0.1, "lowest frequency", "Hz", 1e-4, 1e4)
    highest: float = described(10.0, "highest frequency", "Hz", 1e-4, 1e4)
    count: int = described(20, "how many sines", "", 1, 1000)
    period: float = described(20.0, "time after which it repeats", "s", 1e-3, 1e5)
    seed: int = described(1, "seed of the phases", "", 0, 2**31)

    def check_together(self) -> None:
        """The band must hold a multiple of the fundamental and stay fine enough to find the peak."""
        if not 1.0 / self.period <= self.lowest * (1 + 1e-9) <= self.highest * (1 + 1e-9):
            raise ParameterError(
                f"multisine: needs 1 / period <= lowest <= highest, got {1 / self.period:g}, {self.lowest:g}"
                f" and {self.highest:g} Hz"
            )
        if self.highest * self.period > 1e5:
            raise ParameterError("multisine: more than 1e5 cycles in a period; shorten it or lower `highest`")

    @cached_property
    def _sines(self) -> tuple[FloatArray, FloatArray, float]:
        """Angular frequencies [rad/s], phases [rad], and the height of each sine."""
        multiples = np.unique(np.round(np.geomspace(self.lowest, self.highest, self.count) * self.period))
        generator = Random(self.seed)
        phases = np.array([2.0 * np.pi * generator.random() for _ in multiples])
        rates = 2.0 * np.pi * multiples / self.period
        instants = np.linspace(0.0, self.period, int(_GRID * multiples[-1]) + 1)
        total = sum(np.sin(rate * instants + phase) for rate, phase in zip(rates, phases, strict=True))
        return rates, phases, self.amplitude / float(np.max(np.abs(total)))

    def shape(self, time: FloatArray) -> FloatArray:
        """The sum."""
        rates, phases, height = self._sines
        total = np.zeros_like(time)
        for rate, phase in zip(rates, phases, strict=True):
            total = total + np.sin(rate * time + phase)
        return height * total

    def slope(self, time: FloatArray) -> FloatArray:
        """Its derivative."""
        rates, phases, height = self._sines
        total = np.zeros_like(time)
        for rate, phase in zip(rates, phases, strict=True):
            total = total + rate * np.cos(rate * time + phase)
        return height * total
