"""A driven axis in short windows: a rigid mass under a measured force, with friction that sticks exactly.

Written apart from the plant that is examined. All windows advance together; a window's start is fitted, or given.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

Array = NDArray[np.float64]

ROUNDS = 5
"""Gauss-Newton steps of the windows' starts: the position is nearly linear in them."""

SLOPE_STEPS = (0.1, 0.03, 0.01)
"""Relative steps of the derivatives, one fit after the other: where friction sticks, the error is rough, and a fit with
the last alone ends where it began."""

NUDGE = 1e-4
"""m/s by which a start's speed is moved to see what it does."""


ABOUT = 20
"""Samples about a start from which its speed is taken: 20 ms, over which the axis' acceleration hardly changes."""

HELD = 1e-8
"""s^2: keeps the speed where it does not matter, as where the axis sticks throughout a window."""


@dataclass(frozen=True)
class Axis:
    """M x'' = F - (forward or backward, by direction) x' - dry(x') sign(x') - load. SI.

    Dry friction is `friction` while sliding fast, and `rise` more at rest, which is lost over `stribeck_velocity`.
    """

    mass: float
    forward: float
    backward: float
    friction: float
    load: float = 0.0
    rise: float = 0.0
    stribeck_velocity: float = 1.0

    def dry(self, velocity: Array) -> Array:
        """Size of the dry friction [N] at a velocity [m/s]."""
        return self.friction + self.rise * np.exp(-((velocity / self.stribeck_velocity) ** 2))


@dataclass(frozen=True)
class Windows:
    """Equal windows of a recording: `force` and `position` (windows, samples), `period` [s] between the samples."""

    force: Array
    position: Array
    period: float

    @classmethod
    def cut(cls, force: Array, position: Array, period: float, length: float) -> Windows:
        """A recording cut into windows of `length` [s]; what remains at its end is left out."""
        samples = round(length / period)
        count = len(force) // samples
        shape = (count, samples)
        return cls(force[: count * samples].reshape(shape), position[: count * samples].reshape(shape), period)


def simulate(axis: Axis, force: Array, position: Array, velocity: Array, period: float) -> Array:
    """Positions (windows, samples) [m] from starts (windows,); the first sample is the start."""
    found = np.empty_like(force)
    x, v = position.copy(), velocity.copy()
    for sample in range(force.shape[1]):
        found[:, sample] = x
        free = v + period * (force[:, sample] - axis.load) / axis.mass
        grip = axis.dry(v) * period / axis.mass
        slipping = np.sign(free) * np.maximum(np.abs(free) - grip, 0.0)
        damping = np.where(slipping > 0.0, axis.forward, axis.backward)
        new = slipping / (1.0 + period * damping / axis.mass)
        x, v = x + 0.5 * period * (v + new), new
    return found


def from_fitted_starts(axis: Axis, windows: Windows) -> Array:
    """Error (windows, samples) [m] with the start of every window fitted to it."""
    x, v = measured_starts(windows)
    error = windows.position - simulate(axis, windows.force, x, v, windows.period)
    for _ in range(ROUNDS):
        moved = windows.position - simulate(axis, windows.force, x, v + NUDGE, windows.period)
        slope = (error - moved) / NUDGE
        mean_error, mean_slope = error.mean(axis=1), slope.mean(axis=1)
        along = slope - mean_slope[:, None]
        stiffness = np.sum(along**2, axis=1) + HELD * error.shape[1]
        change = np.sum((error - mean_error[:, None]) * along, axis=1) / stiffness
        next_x, next_v = x + mean_error - mean_slope * change, v + change
        new = windows.position - simulate(axis, windows.force, next_x, next_v, windows.period)
        better = np.sum(new**2, axis=1) < np.sum(error**2, axis=1)
        x, v = np.where(better, next_x, x), np.where(better, next_v, v)
        error = np.where(better[:, None], new, error)
    return error


def measured_starts(windows: Windows) -> tuple[Array, Array]:
    """Position and speed at each window's start, of a parabola through its first samples."""
    time = windows.period * np.arange(ABOUT)
    _, speed, place = np.polyfit(time, windows.position[:, :ABOUT].T, 2)
    return np.asarray(place), np.asarray(speed)


def cut_ahead(force: Array, position: Array, period: float, length: float, every: float) -> tuple[Windows, Array]:
    """Overlapping windows of `length` [s], one every so many seconds; and the speed at their starts [m/s], of parabolas
    through the samples about them."""
    samples = round(length / period)
    speed = savgol_filter(position, ABOUT + 1, 2, deriv=1, delta=period)
    starts = np.arange(ABOUT, len(force) - samples, round(every / period))
    rows = starts[:, None] + np.arange(samples)
    return Windows(force[rows], position[rows], period), speed[starts]


def fit_axis(start: Axis, windows: list[Windows], with_load: bool) -> Axis:
    """The values that leave least in all windows from fitted starts.

    With a load, viscous friction is the same both ways; without one it may differ by direction: as many values.
    """
    mean = 0.5 * (start.forward + start.backward)
    first = [start.mass, mean, start.load, start.friction] if with_load else [
        start.mass, start.forward, start.backward, start.friction]  # fmt: skip
    scale = np.array([start.mass, mean, max(mean, 10.0) if not with_load else 10.0, max(start.friction, 5.0)])

    def axis(values: Array) -> Axis:
        mass, forward, other, friction = (scale * values).tolist()
        friction = max(friction, 0.0)
        return Axis(mass, forward, forward, friction, other) if with_load else Axis(mass, forward, other, friction)

    def residual(values: Array) -> Array:
        made = axis(values)
        return 1e3 * np.concatenate([from_fitted_starts(made, each).ravel() for each in windows])

    values = np.array(first) / scale
    for step in SLOPE_STEPS:
        values = least_squares(residual, values, diff_step=step, xtol=1e-6, ftol=1e-7).x
    return axis(values)


def rms(error: Array) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(error**2)))
