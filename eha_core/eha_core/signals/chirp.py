"""A sine whose frequency sweeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.errors import ParameterError
from eha_core.signals.signal import FloatArray, Signal, described


@dataclass(frozen=True)
class Chirp(Signal):
    """A sine whose frequency goes from one end to the other within `duration` and stays there.

    It sweeps linearly, or by equal factors in equal times where `logarithmic`; the phase is the integral of the
    frequency, so nothing jumps.
    """

    amplitude: float = described(0.01, "height of the sine", "same")
    start_frequency: float = described(0.1, "frequency at time 0", "Hz", 1e-6, 1e4)
    end_frequency: float = described(10.0, "frequency after the sweep", "Hz", 1e-6, 1e4)
    duration: float = described(20.0, "duration of the sweep", "s", 1e-3)
    logarithmic: bool = described(True, "whether the frequency grows by equal factors in equal times")

    def check_together(self) -> None:
        """A logarithmic sweep must lead somewhere."""
        if self.logarithmic and self.start_frequency == self.end_frequency:
            raise ParameterError("chirp: start_frequency equals end_frequency; give two, or logarithmic=false")

    def _frequency(self, time: FloatArray) -> FloatArray:
        share = np.minimum(time / self.duration, 1.0)
        if self.logarithmic:
            return np.asarray(self.start_frequency * (self.end_frequency / self.start_frequency) ** share)
        return np.asarray(self.start_frequency + (self.end_frequency - self.start_frequency) * share)

    def _cycles(self, time: FloatArray) -> FloatArray:
        swept = np.minimum(time, self.duration)
        if self.logarithmic:
            rate = np.log(self.end_frequency / self.start_frequency) / self.duration
            cycles = (self._frequency(swept) - self.start_frequency) / rate
        else:
            cycles = 0.5 * (self.start_frequency + self._frequency(swept)) * swept
        return np.asarray(cycles + self.end_frequency * (time - swept))

    def shape(self, time: FloatArray) -> FloatArray:
        """The sine of the phase."""
        return np.asarray(self.amplitude * np.sin(2.0 * np.pi * self._cycles(time)))

    def slope(self, time: FloatArray) -> FloatArray:
        """Its derivative."""
        rate = 2.0 * np.pi * self._frequency(time)
        return np.asarray(self.amplitude * rate * np.cos(2.0 * np.pi * self._cycles(time)))
