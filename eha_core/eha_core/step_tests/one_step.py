"""One step of the command: whether it moved anything, how, and whether the motion stopped before the command ended."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eha_core.step_tests.commanded import FEWEST, Commanded
from eha_core.step_tests.law import Fit, fit_rest, fit_step, fit_stop, timed
from eha_core.step_tests.result import Array, Estimate, Record, Step

DECISIVE = 25.0
"""Fall of the sum of squares, in variances of the noise, from which a motion or a stop is there: the square of five
standard deviations (assumed)."""

OUTSIDE_NOISE = 3.0
"""Standard deviations of the noise that a motion must exceed (assumed)."""

STEADY = 3.0
"""Time constants after which a speed counts as steady: 95 % of it are reached."""

STOPPED = 0.1
"""Share of the speed below which a motion counts as stopped (assumed)."""

CUSHION = 0.1
"""Share of the motion before a stop that is left out: a cushion may slow it down there (assumed)."""


_FIGURES = ("delay", "rise", "speed", "stopping")


@dataclass(frozen=True)
class _Part:
    """Instants since a change of the command [s] and the motion."""

    time: Array
    motion: Array
    is_velocity: bool

    def between(self, first: float, last: float) -> _Part:
        kept = (self.time >= first) & (self.time <= last)
        return _Part(self.time[kept], self.motion[kept], self.is_velocity)


def read_step(record: Record, commanded: Commanded) -> Step | str:
    """The figures of a step, or why there are none."""
    whole = _Part(record.time - commanded.on, record.motion, record.is_velocity)
    length = commanded.off - commanded.on
    on = whole.between(commanded.rest - commanded.on, length)
    rest = on.between(-np.inf, 0.0)
    if rest.time.size < FEWEST or on.time.size - rest.time.size < FEWEST:
        return "too few samples of the motion before or during the step; record rest before it, and faster"
    still = fit_rest(rest.time, rest.motion, on.is_velocity)
    least = max(still.squares / (rest.time.size - 2), _resolved(record.motion) ** 2 / 12.0)
    step = _empty(record, commanded, rest, still, least**0.5)
    fit, halted = (law(on.time, on.motion, on.is_velocity, least) for law in (fit_step, fit_stop))
    if not _moves(on, min(fit, halted, key=lambda one: one.squares), step):
        reason = "nothing moved beyond the noise"
        return replace(step, open=dict.fromkeys(_FIGURES, reason), drawn=_drawn(on, None))
    step = _with_stop(replace(step, moved=True), on, fit, halted)
    if step.stopped_after is not None:
        begun = max(float(halted.values[0]), 0.0)
        on = on.between(-np.inf, step.stopped_after - CUSHION * (step.stopped_after - begun))
        if np.count_nonzero(on.time > begun) < FEWEST:
            reason = "the motion stopped too soon after it began; begin farther from the stop"
            return replace(step, open=dict.fromkeys(_FIGURES, reason), drawn=_drawn(on, None))
        fit = fit_step(on.time, on.motion, on.is_velocity, least)
    step = _with_rise(step, on, fit, commanded.resolution)
    return _with_stopping(step, whole, commanded, least)


def _empty(record: Record, commanded: Commanded, rest: _Part, still: Fit, noise: float) -> Step:
    """A step of which nothing but the rest before it is known."""
    after = record.motion[(record.time > 0.5 * (commanded.off + commanded.until)) & (record.time <= commanded.until)]
    last = after if after.size else record.motion[-1:]
    places = (0.0, 0.0) if rest.is_velocity else (float(np.median(rest.motion[-FEWEST:])), float(np.median(last)))
    return Step(
        record.source, commanded.on, commanded.off - commanded.on, commanded.level, False, None, None, None, None,
        None, None, noise, still.estimate(-1), places, commanded.resolution,
    )  # fmt: skip


def _moves(on: _Part, law: Fit, step: Step) -> bool:
    """Whether a law explains what rest and drift do not."""
    rest = fit_rest(on.time, on.motion, on.is_velocity)
    # the samples' likeness is that of the law: a motion that is taken for rest is alike by itself
    gained = (rest.squares - law.squares) / (law.variance * law.inflation)
    during = on.time > 0.0
    drift = np.zeros(on.time.size) if on.is_velocity else step.drift.value * on.time
    travel, drifted = (float(np.ptp(moved[during])) for moved in (law.curve - drift, drift))
    return gained > DECISIVE and travel > OUTSIDE_NOISE * step.noise and travel > drifted


def _with_stop(step: Step, on: _Part, fit: Fit, halted: Fit) -> Step:
    """The step with the place where its motion stopped while the command held, if it did."""
    stop = float(halted.values[-1])
    rested = on.between(stop, np.inf)
    if rested.time.size < FEWEST:
        return step
    rest = fit_rest(rested.time, rested.motion, on.is_velocity)
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


def _with_rise(step: Step, on: _Part, fit: Fit, resolution: float) -> Step:
    """The step with delay, time constant and speed, as far as its length shows them."""
    delay, rise = timed(on.time, on.motion, on.is_velocity, fit)
    delay, speed = _blurred(delay, resolution), fit.estimate(-3)
    open_now: dict[str, str] = {}
    left = float(on.time[-1]) - delay.value
    ends = "the stop" if step.stopped_after is not None else "the end of the command"
    cure = "begin farther from the stop" if step.stopped_after is not None else "hold the command longer"
    if left < STEADY * (rise.value + rise.reach):
        reason = f"the speed may still have been rising at {ends}; {cure}"
        open_now |= {"speed": reason, "rise": reason}
    if delay.value < -delay.reach:
        open_now["delay"] = "the motion begins before the command changes; record both by one clock"
    elif delay.reach > 0.5 * left:
        open_now["delay"] = f"the noise hides it; {cure}, or record with less noise"
    return replace(
        step, delay=None if "delay" in open_now else delay, rise=None if "rise" in open_now else rise,
        speed=None if "speed" in open_now else speed, open=step.open | open_now, drawn=_drawn(on, fit),
    )  # fmt: skip


def _with_stopping(step: Step, whole: _Part, commanded: Commanded, least: float) -> Step:
    """The step with the delay of stopping: the law of a step, on top of the steady motion before."""
    length = commanded.off - commanded.on
    reason = ""
    if not commanded.goes_back:
        reason = "the record ends before the command goes back; record on until all is at rest"
    elif step.stopped_after is not None:
        reason = "the motion had stopped before the command ended"
    elif step.speed is None or step.delay is None or step.rise is None:
        reason = "the speed was not steady when the command ended; hold it longer"
    else:
        begun = step.delay.value + STEADY * step.rise.value
        first = max(begun, 0.5 * length)
        tail = _Part(whole.time - length, whole.motion, whole.is_velocity)
        tail = tail.between(first - length, min(commanded.until - commanded.off, length))
        if min(np.count_nonzero(tail.time < 0.0), np.count_nonzero(tail.time > 0.0)) < FEWEST:
            reason = "too few samples after the command ended; record on until all is at rest"
        else:
            fit = fit_step(tail.time, tail.motion, tail.is_velocity, least)
            before = float(fit.values[0 if tail.is_velocity else 1])
            after = before + float(fit.values[-3])
            stopping, _ = timed(tail.time, tail.motion, tail.is_velocity, fit)
            if abs(after - step.drift.value) <= STOPPED * abs(before) and stopping.reach < tail.time[-1]:
                return replace(step, stopping=_blurred(stopping, commanded.resolution))
            reason = "no clear stop follows the command's end; record on until all is at rest"
    return replace(step, open=step.open | {"stopping": reason})


def _blurred(estimate: Estimate, resolution: float) -> Estimate:
    """An instant since the command's change, which is known to within some time only."""
    return Estimate(estimate.value, float(np.hypot(estimate.reach, 1.96 * resolution / 12.0**0.5)))


def _resolved(motion: Array) -> float:
    """The smallest step between two samples where the motion stands in a staircase of its sensor; else zero."""
    steps = np.abs(np.diff(motion))
    moving = steps[steps > 0.0]
    return float(np.min(moving)) if moving.size and moving.size < 0.5 * steps.size else 0.0


def _drawn(on: _Part, fit: Fit | None) -> tuple[Array, Array, Array]:
    return on.time, on.motion, fit.curve if fit is not None else np.full(on.time.size, np.nan)
