"""Whether a step of the command moved anything, and whether the motion stopped while the command held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eha_core.step_tests.commanded import FEWEST
from eha_core.step_tests.law import Fit, at_rest, fit_rest
from eha_core.step_tests.result import Array, Estimate, Step

DECISIVE = 25.0
"""Fall of the sum of squares, in variances of the noise, from which a motion or a stop is there: the square of five
standard deviations (assumed)."""

OUTSIDE_NOISE = 3.0
"""Standard deviations of the noise that a motion must exceed (assumed)."""

STOPPED = 0.1
"""Share of the speed below which a motion counts as stopped (assumed)."""


@dataclass(frozen=True)
class Part:
    """Instants since a change of the command [s] and the motion."""

    time: Array
    motion: Array
    is_velocity: bool

    def between(self, first: float, last: float) -> Part:
        """The samples from one instant to another."""
        kept = (self.time >= first) & (self.time <= last)
        return Part(self.time[kept], self.motion[kept], self.is_velocity)


def is_settled(rest: Part, still: Fit) -> bool:
    """Whether the motion before a step is at rest or drifts evenly, and is not still settling."""
    columns = np.column_stack([at_rest(rest.time, rest.is_velocity), rest.time ** (1 if rest.is_velocity else 2)])
    curve = columns @ np.linalg.lstsq(columns, rest.motion, rcond=None)[0]
    larger = still.again(columns, curve, rest.motion)
    return (still.squares - larger.squares) <= DECISIVE * larger.variance * larger.inflation


def moves(on: Part, law: Fit, step: Step) -> bool:
    """Whether a law explains what rest and drift do not."""
    rest = fit_rest(on.time, on.motion, on.is_velocity, 0.0)
    # the samples' likeness is that of the law: a motion that is taken for rest is alike by itself
    gained = (rest.squares - law.squares) / (law.variance * law.inflation)
    if on.is_velocity or gained <= DECISIVE:
        return gained > DECISIVE
    during = on.time > 0.0
    drift = step.drift.value * on.time
    travel, drifted = (float(np.ptp(moved[during])) for moved in (law.curve - drift, drift))
    return travel > OUTSIDE_NOISE * step.noise and travel > drifted


def without_motion(on: Part, still: Fit, step: Step) -> tuple[bool, float]:
    """Whether it is clear that nothing moved, and the speed below which a motion would not have been seen.

    The motion of the last quarter is compared with that at rest, drift included.
    """
    length = float(on.time[-1])
    late = on.between(0.75 * length, np.inf)
    ahead = at_rest(np.array([np.mean(late.time)]), on.is_velocity)[0]
    variance = ahead @ still.covariance @ ahead + still.variance * still.inflation / late.time.size
    deviation = float(np.sqrt(variance))
    is_clear = abs(float(np.mean(late.motion)) - float(ahead @ still.values)) <= OUTSIDE_NOISE * deviation
    if on.is_velocity:
        return is_clear, DECISIVE**0.5 * deviation
    # a motion may begin as late as in the middle
    seen = max(DECISIVE**0.5 * deviation, OUTSIDE_NOISE * step.noise) / (0.5 * length)
    return is_clear, max(seen, abs(step.drift.value))


def with_stop(step: Step, on: Part, fit: Fit, halted: Fit) -> Step:
    """The step with the place where its motion stopped while the command held, if it did."""
    stop = float(halted.values[-1])
    rested = on.between(stop, np.inf)
    if rested.time.size < FEWEST:
        return step
    rest = fit_rest(rested.time, rested.motion, on.is_velocity, 0.0)
    before = on.between(0.5 * stop, stop)
    if before.time.size < 2:
        return step
    drift = step.drift.value
    if on.is_velocity:
        speed, left = float(np.median(before.motion)) - drift, float(rest.values[0]) - drift
        missed = abs(speed)
    else:
        speed = float(np.ptp(before.motion)) / max(float(np.ptp(before.time)), 1e-9)
        left = float(rest.values[1]) - drift
        missed = abs(speed) * float(np.ptp(rested.time))
    gained = (fit.squares - halted.squares) / halted.variance
    if gained < DECISIVE or abs(left) > STOPPED * abs(speed) or missed < OUTSIDE_NOISE * 2.0 * step.noise:
        return step
    half = rested.between(0.5 * (stop + float(rested.time[-1])), np.inf)
    reach = 1.96 * step.noise * (rest.inflation / half.time.size) ** 0.5
    place = None if on.is_velocity else Estimate(float(np.mean(half.motion)), reach)
    return replace(step, stopped_after=stop, stopped_at=place)
