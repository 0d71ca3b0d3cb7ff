"""Gains of a PI position loop with velocity feedforward, from the plant's linearisation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eha_core.control.linear_model import STATES, reduced, velocity_gain
from eha_core.control.pid import CROSSOVER, RESET_TIME
from eha_core.errors import ParameterError

LARGEST_SENSITIVITY = 2.0
"""The highest peak of 1 / |1 + L| over frequency: a gain margin of at least 2, a phase margin of at least 29 degrees.

Source: K. J. Astrom, T. Hagglund, "Advanced PID Control", ISA (2006), section 4.6 (1.2 to 2).
"""

Complex = NDArray[np.complex128]

_SHARES = 0.95 ** np.arange(90)  # of CROSSOVER, down to a hundredth of it
_FREQUENCIES = np.geomspace(0.03, 3e4, 1500)  # rad/s: below the slowest loop to above the fastest valve
_ABOUT_A_POLE = np.linspace(-30.0, 30.0, 181)  # in half widths of its resonance, which may be narrower than that grid


class PositionGains(NamedTuple):
    """u = proportional e + integral of e + feedforward v_r, and the loop that this makes."""

    proportional: float
    """[V/m]."""
    integral: float
    """[V/(m s)]."""
    feedforward: float
    """[V/(m/s)]."""
    crossover: float
    """Proportional gain over `feedforward`: the loop's crossover without its lags [rad/s]."""
    sensitivity: float
    """The peak of 1 / |1 + L|."""


def position_gains(parameters: Mapping[str, float], period: float) -> PositionGains:
    """Return the gains with the PID's crossover, or the largest below it whose peak of the sensitivity is allowed.

    The reset time is the same multiple of 1 / crossover as the PID's. The loop has the linearised plant's lags and
    resonance, the command's delay, and half a period for which a command is held.

    Args:
        parameters: the actuator's parameters by catalogue name (all of them).
        period: time between two commands [s].

    Raises ParameterError where even with a hundredth of the PID's crossover the loop is unstable or its peak higher.
    """
    gain = velocity_gain(parameters)
    crossovers = CROSSOVER * _SHARES[::-1]
    s, position = _position_response(parameters)
    plant = position * np.exp(-s * (0.5 * period + parameters["command_delay.delay"])) / gain
    reset_times = CROSSOVER * RESET_TIME / crossovers
    loops = crossovers[:, None] * plant * (1.0 + 1.0 / (reset_times[:, None] * s))
    peaks = (1.0 / np.abs(1.0 + loops)).max(axis=1)
    allowed = np.cumprod(peaks <= LARGEST_SENSITIVITY).astype(bool)  # from the slowest loop on
    if not allowed.any() or not _is_stable(parameters, crossovers[0] / gain, reset_times[0]):
        raise ParameterError(
            f"no position loop down to {crossovers[0]:.2g} rad/s is stable with a peak of the sensitivity of"
            f" {LARGEST_SENSITIVITY:g} or less; check valve, oil, mass and damping of the parameters"
        )
    crossover, peak = float(crossovers[allowed][-1]), float(peaks[allowed][-1])
    proportional = crossover / gain
    return PositionGains(proportional, proportional * crossover / (CROSSOVER * RESET_TIME), 1.0 / gain, crossover, peak)


def _position_response(parameters: Mapping[str, float]) -> tuple[Complex, Complex]:
    """Imaginary frequencies [rad/s], close about the plant's resonances, and the linearised position per volt [m/V]."""
    a, b = reduced(parameters)
    resonances = [pole for pole in np.linalg.eigvals(a) if pole.imag > 0.0]
    frequencies = np.concatenate([_FREQUENCIES, *(pole.imag + _ABOUT_A_POLE * pole.real for pole in resonances)])
    s = 1j * frequencies[frequencies > 0.0]
    states = np.linalg.solve(s[:, None, None] * np.eye(len(STATES)) - a, np.tile(b[:, None], (len(s), 1, 1)))
    return s, states[:, STATES.index("position"), 0]


def _is_stable(parameters: Mapping[str, float], proportional: float, reset_time: float) -> bool:
    """Whether the loop without delays is: a peak of the sensitivity does not say on which side of it a loop lies."""
    a, b = reduced(parameters)
    loop = np.zeros((len(b) + 1, len(b) + 1))
    position = STATES.index("position")
    loop[:-1, :-1], loop[:-1, -1] = a, b * proportional / reset_time
    loop[:-1, position] -= b * proportional
    loop[-1, position] = -1.0
    return bool(np.linalg.eigvals(loop).real.max() < 0.0)
