"""The closed form of a step's motion, and its fit by least squares.

Law: after a dead time d the speed rises with a time constant T to v. With s = t - d since the command's change,
    position = p0 + b t + v (s - T (1 - exp(-s / T))),    velocity = b + v (1 - exp(-s / T)),    both with s >= 0,
where b is the drift at rest. Slowing is the same law on top of a steady motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2
from scipy.stats import t as student

from eha_core.step_tests.result import Array, Estimate

MOST_ALIKE = 0.99
"""Largest correlation of neighbouring residuals that is reckoned with: one sample in 200 then counts (assumed)."""

SURE = 0.999
"""Probability with which a speed's interval holds what a slower rise would make of it: with 95 %, most of the steps
that pass as just steady would be those whose time constant is found too small by chance (assumed)."""

STARTS = 200
"""Samples on which initial values are sought (assumed)."""

_DELAYS = 0.9 * np.linspace(0.0, 1.0, 40) ** 2
_LAGS = np.array([0.003, 0.01, 0.03, 0.1, 0.3])
_STOPS = np.linspace(0.05, 0.99, 24)
"""Initial values, in parts of the step's length."""

_SHORTEST = 1e-9  # s; keeps a quotient finite
_ALIKE = 1e-10  # keeps an inverse finite


@dataclass(frozen=True)
class Fit:
    """A fitted law: values of the rest, speed, delay [s], time constant [s]; `freedom` counts independent samples."""

    values: Array
    covariance: Array
    curve: Array
    squares: float
    variance: float
    inflation: float
    freedom: float

    def estimate(self, place: int) -> Estimate:
        """A value, counted from the end, with its interval."""
        deviation = float(np.sqrt(max(self.covariance[place, place], 0.0)))
        return Estimate(float(self.values[place]), float(student.ppf(0.975, self.freedom)) * deviation)

    def again(self, slopes: Array, curve: Array, motion: Array) -> Fit:
        """A linear law of the same motion with other columns."""
        values: Array = np.asarray(np.linalg.lstsq(slopes, motion, rcond=None)[0], dtype=np.float64)
        return _fit(values, slopes, curve, motion, 0.0)


def at_rest(time: Array, is_velocity: bool) -> Array:
    """The columns of the motion at rest: a constant, and of a position the drift."""
    return np.ones((time.size, 1)) if is_velocity else np.column_stack([np.ones(time.size), time])


def shape(time: Array, delay: float, lag: float, is_velocity: bool) -> Array:
    """The motion of a speed of one that begins after `delay` and rises with `lag`; time since the change [s]."""
    since, lag = np.maximum(time - delay, 0.0), max(lag, _SHORTEST)
    risen = -np.expm1(-since / lag)
    return risen if is_velocity else since - lag * risen


def fit_rest(time: Array, motion: Array, is_velocity: bool, least: float) -> Fit:
    """The motion at rest."""
    columns = at_rest(time, is_velocity)
    values: Array = np.asarray(np.linalg.lstsq(columns, motion, rcond=None)[0], dtype=np.float64)
    return _fit(values, columns, columns @ values, motion, least)


def fit_step(time: Array, motion: Array, is_velocity: bool, least: float) -> Fit:
    """The law of a step.

    Args:
        time: instants since the command's change [s], from rest on.
        motion: position or velocity.
        is_velocity: which of both.
        least: least variance of the noise.
    """
    length = float(time[-1])
    some = slice(None, None, max(1, time.size // STARTS))
    pairs = [(delay * length, lag * length) for delay in _DELAYS for lag in _LAGS]
    shapes = np.array([shape(time[some], *pair, is_velocity) for pair in pairs])
    best = pairs[_best(shapes, time[some], motion[some], is_velocity)]
    rest = at_rest(time, is_velocity)
    linear = np.linalg.lstsq(np.column_stack([rest, shape(time, *best, is_velocity)]), motion, rcond=None)[0]
    scale = max(float(np.ptp(motion)), _SHORTEST)

    def residual(values: Array) -> Array:
        law = rest @ values[:-3] + values[-3] * shape(time, values[-2], values[-1], is_velocity)
        left: Array = (law - motion) / scale
        return left

    free = [np.inf] * (rest.shape[1] + 1)
    bounds = ([-x for x in free] + [float(time[0]), 0.0], [*free, length, length])
    start = np.clip([*linear, *best], *bounds)
    found = least_squares(residual, start, bounds=bounds, x_scale="jac", max_nfev=100)
    return _fit(found.x, scale * found.jac, scale * found.fun + motion, motion, least)


def fit_stop(time: Array, motion: Array, is_velocity: bool, least: float) -> Fit:
    """The law of a step that stops while the command holds; its values are delay, time constant and that instant."""
    some = slice(None, None, max(1, time.size // STARTS))
    coarse, length = time[some], float(time[-1])
    trials = [(delay * length, lag * length, stop * length)
              for delay in _DELAYS[::2] for lag in _LAGS[1:] for stop in _STOPS if stop > delay]  # fmt: skip
    shapes = np.array([stopped(coarse, *trial, is_velocity) for trial in trials])
    start = trials[_best(shapes, coarse, motion[some], is_velocity)]
    rest, scale = at_rest(time, is_velocity), max(float(np.ptp(motion)), _SHORTEST)

    def residual(values: Array) -> Array:
        columns = np.column_stack([rest, stopped(time, values[0], values[1], values[2], is_velocity)])
        left: Array = (columns @ np.linalg.lstsq(columns, motion, rcond=None)[0] - motion) / scale
        return left

    bounds = ([float(time[0]), 0.0, 0.0], [length, length, length])
    found = least_squares(residual, np.clip(start, *bounds), bounds=bounds, x_scale=[length] * 3, max_nfev=60)
    return _fit(found.x, scale * found.jac, scale * found.fun + motion, motion, least)


def slowest(time: Array, motion: Array, is_velocity: bool, fit: Fit, sure: float) -> tuple[float, float]:
    """The largest time constant that the motion does not exclude so surely [s], and the speed that goes with it.

    Where noise hides the rise, squares are far from parabolic in it, and its interval by least squares is wrong.
    """
    length, step = float(time[-1]), float(np.median(np.diff(time)))
    basis = np.linalg.qr(at_rest(time, is_velocity))[0]
    most = fit.squares + float(chi2.ppf(sure, 1)) * fit.variance * fit.inflation
    total = float(fit.values[-2] + fit.values[-1])
    everywhere = length * np.linspace(0.0, 0.9, 40)
    for lag in length * np.geomspace(1.0, 0.002, 40):
        near = total - lag + np.linspace(-1.0, 1.0, 41) * max(0.3 * lag, 2.0 * step)
        shapes = np.array([shape(time, delay, lag, is_velocity) for delay in (*everywhere, *near)])
        squares = _squares(shapes, basis, motion)
        if np.min(squares) <= most:
            columns = np.column_stack([basis, shapes[int(np.argmin(squares))]])
            return float(lag), float(np.linalg.lstsq(columns, motion, rcond=None)[0][-1])
    return 0.0, float(fit.values[-3])


@dataclass(frozen=True)
class Figures:
    """Delay [s], time constant [s], speed, and the largest time constant that is possible [s]."""

    delay: Estimate
    rise: Estimate
    speed: Estimate
    slowest: float


def figures(time: Array, motion: Array, is_velocity: bool, fit: Fit) -> Figures:
    """The figures of a fitted step, which stand in for each other where samples are few."""
    delay, rise, speed = fit.estimate(-2), fit.estimate(-1), fit.estimate(-3)
    if rise.reach < 0.5 * rise.value:
        return Figures(delay, rise, speed, rise.value + rise.reach)
    lag, _ = slowest(time, motion, is_velocity, fit, 0.95)
    most = max(lag - rise.value, min(rise.value, rise.reach))
    _, other = slowest(time, motion, is_velocity, fit, SURE)
    speed = Estimate(speed.value, max(speed.reach, abs(other - speed.value)))
    # the sum of both is what the later motion shows
    along = fit.covariance[-2:, -2:].sum()
    total = float(student.ppf(0.975, fit.freedom)) * float(np.sqrt(max(along, 0.0)))
    delay, rise = Estimate(delay.value, float(np.hypot(most, total))), Estimate(rise.value, most)
    return Figures(delay, rise, speed, rise.value + most)


def stopped(time: Array, delay: float, lag: float, stop: float, is_velocity: bool) -> Array:
    """The motion of a speed of one that stops at an instant."""
    moved = shape(np.minimum(time, stop), delay, lag, is_velocity)
    return np.where(time < stop, moved, 0.0) if is_velocity else moved


def _best(shapes: Array, time: Array, motion: Array, is_velocity: bool) -> int:
    """Which of the shapes (k, n) explains most of a motion beyond rest."""
    return int(np.argmin(_squares(shapes, np.linalg.qr(at_rest(time, is_velocity))[0], motion)))


def _squares(shapes: Array, basis: Array, motion: Array) -> Array:
    """What each of the shapes (k, n) with rest (n, r; orthonormal) leaves of a motion: sums of squares."""
    left = motion - basis @ (basis.T @ motion)
    beyond = shapes - (shapes @ basis) @ basis.T
    power = np.maximum(np.sum(beyond**2, axis=1), 1e-12 * np.maximum(np.sum(shapes**2, axis=1), _SHORTEST))
    explained: Array = (beyond @ left) ** 2 / power
    return float(left @ left) - explained


def _fit(values: Array, slopes: Array, curve: Array, motion: Array, least: float) -> Fit:
    """The covariance, with neighbouring samples counted as one where their residuals are alike."""
    residual = motion - curve
    squares = float(residual @ residual)
    alike = float(residual[1:] @ residual[:-1]) / squares if squares > 0.0 else 0.0
    alike = float(np.clip(alike, 0.0, MOST_ALIKE))
    inflation = (1.0 + alike) / (1.0 - alike)
    spare = max(motion.size - values.size, 1)
    variance = max(squares / spare, least)
    # what the samples do not tell apart must have a large variance, which a pseudo-inverse would make zero
    sizes = np.maximum(np.linalg.norm(slopes, axis=0), _SHORTEST)
    scaled = slopes / sizes
    inverse = np.linalg.inv(scaled.T @ scaled + _ALIKE * np.eye(values.size))
    covariance = variance * inflation * inverse / np.outer(sizes, sizes)
    return Fit(values, covariance, curve, squares, variance, inflation, max(spare / inflation, 1.0))
