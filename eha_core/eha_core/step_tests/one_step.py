"""One step of the command: whether it moved anything, how, and whether the motion stopped before the command ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eha_core.step_tests.commanded import FEWEST, Commanded
from eha_core.step_tests.law import Fit, at_rest, figures, fit_rest, fit_step, fit_stop
from eha_core.step_tests.moved import DECISIVE, STOPPED, Part, is_settled, moves, with_stop, without_motion
from eha_core.step_tests.result import Array, Estimate, Record, Step

STEADY = 3.0
"""Time constants after which a speed counts as steady: 95 % of it are reached."""

AT_REST = 0.5
"""Share of a step's speed that the drift before it may have; with more, the record began in the midst of a motion
(assumed)."""

HIDDEN = 0.25
"""Share of the time that a motion lasts by which a delay may be unsure and still say something (assumed)."""

SMALLEST = 1e-6
"""Share of the largest motion below which no sensor resolves it (assumed)."""

CUSHION = 0.1
"""Share of the motion before a stop that is left out: a cushion may slow it down there (assumed)."""


_FIGURES = ("delay", "rise", "speed", "stopping")


def read_step(record: Record, commanded: Commanded, least: float) -> Step | str:
    """The figures of a step, or why there are none; `least` is the least variance of the sensor."""
    whole = Part(record.time - commanded.on, record.motion, record.is_velocity)
    length = commanded.off - commanded.on
    on = whole.between(commanded.rest - commanded.on, length)
    rest = on.between(-np.inf, 0.0)
    if rest.time.size < FEWEST or on.time.size - rest.time.size < FEWEST:
        return "too few samples of the motion before or during the step; record rest before it, and faster"
    still = fit_rest(rest.time, rest.motion, on.is_velocity, least)
    step = _empty(record, commanded, rest, still)
    least = still.variance
    if not is_settled(rest, still):
        reason = "the motion had not come to rest before the step; wait until it has"
        return _open(step, on, ("level", *_FIGURES), reason)
    fit, halted = (law(on.time, on.motion, on.is_velocity, least) for law in (fit_step, fit_stop))
    if not moves(on, min(fit, halted, key=lambda one: one.squares), step):
        is_clear, unseen = without_motion(on, still, step)
        step = _open(replace(step, unseen=unseen), on, _FIGURES, "nothing moved beyond the noise")
        reason = "whether it moved is not clear; begin at neutral and at rest, and hold the command longer"
        return step if is_clear else _open(step, on, ("level", *_FIGURES), reason)
    step = with_stop(replace(step, moved=True), on, fit, halted)
    if step.stopped_after is not None:
        begun = max(float(halted.values[0]), 0.0)
        on = on.between(-np.inf, step.stopped_after - CUSHION * (step.stopped_after - begun))
        if np.count_nonzero(on.time > begun) < FEWEST:
            reason = "the motion stopped too soon after it began; begin farther from the stop"
            return _open(step, on, _FIGURES, reason)
        fit = fit_step(on.time, on.motion, on.is_velocity, least)
    if abs(step.drift.value) > AT_REST * abs(float(fit.values[-3])):
        reason = "the machine moved before the step about as fast as after it; begin at neutral and at rest"
        return _open(step, on, ("level", *_FIGURES), reason)
    step = _with_rise(step, on, fit, commanded.resolution)
    return _with_stopping(step, whole, commanded, least)


def _empty(record: Record, commanded: Commanded, rest: Part, still: Fit) -> Step:
    """A step of which nothing but the rest before it is known."""
    after = record.motion[(record.time > 0.5 * (commanded.off + commanded.until)) & (record.time <= commanded.until)]
    last = after if after.size else record.motion[-1:]
    places = (0.0, 0.0) if rest.is_velocity else (float(np.median(rest.motion[-FEWEST:])), float(np.median(last)))
    return Step(
        record.source, commanded.on, commanded.off - commanded.on, commanded.level, False, None, None, None, None,
        None, None, still.variance**0.5, still.estimate(-1), places, commanded.resolution,
    )  # fmt: skip


def _open(step: Step, on: Part, figures: Sequence[str], reason: str) -> Step:
    return replace(step, open=step.open | dict.fromkeys(figures, reason), drawn=_drawn(on, None))


def _with_rise(step: Step, on: Part, fit: Fit, resolution: float) -> Step:
    """The step with delay, time constant and speed, as far as its length shows them."""
    found = figures(on.time, on.motion, on.is_velocity, fit)
    rise, delay = found.rise, _blurred(found.delay, resolution)
    speed = _with_change(found.speed, on, delay.value + STEADY * rise.value)
    open_now: dict[str, str] = {}
    left = float(on.time[-1]) - delay.value
    ends = "the stop" if step.stopped_after is not None else "the end of the command"
    cure = "begin farther from the stop" if step.stopped_after is not None else "hold the command longer"
    if left < STEADY * found.slowest:
        reason = f"the speed may still have been rising at {ends}; {cure}"
        open_now |= {"speed": reason, "rise": reason}
    if delay.value < -delay.reach:
        open_now["delay"] = "the motion begins before the command changes; record both by one clock"
    elif delay.reach > HIDDEN * left:
        open_now["delay"] = f"the noise hides it; {cure}, or record with less noise"
    return replace(
        step, delay=None if "delay" in open_now else delay, rise=None if "rise" in open_now else rise,
        speed=None if "speed" in open_now else speed, open=step.open | open_now, drawn=_drawn(on, fit),
    )  # fmt: skip


def _with_stopping(step: Step, whole: Part, commanded: Commanded, least: float) -> Step:
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
        first = max(begun, 0.75 * length)
        tail = Part(whole.time - length, whole.motion, whole.is_velocity)
        tail = tail.between(first - length, min(commanded.until - commanded.off, length))
        if min(np.count_nonzero(tail.time < 0.0), np.count_nonzero(tail.time > 0.0)) < FEWEST:
            reason = "too few samples after the command ended; record on until all is at rest"
        else:
            fit = fit_step(tail.time, tail.motion, tail.is_velocity, least)
            before = float(fit.values[0 if tail.is_velocity else 1])
            after = before + float(fit.values[-3])
            stopping = figures(tail.time, tail.motion, tail.is_velocity, fit).delay
            if stopping.reach > HIDDEN * length:
                reason = "the noise hides it; record with less noise"
            elif abs(after - step.drift.value) <= STOPPED * abs(before) and stopping.value > -stopping.reach:
                return replace(step, stopping=_blurred(stopping, commanded.resolution))
            else:
                reason = "no clear stop follows the command's end; record on until all is at rest"
    return replace(step, open=step.open | {"stopping": reason})


def _with_change(speed: Estimate, on: Part, begun: float) -> Estimate:
    """A speed whose interval holds half of what it changes by while it should be steady, where that is significant."""
    steady = on.between(begun, np.inf)
    if steady.time.size < 2 * FEWEST:
        return speed
    columns = np.column_stack([at_rest(steady.time, on.is_velocity), steady.time ** (1 if on.is_velocity else 2)])
    values = np.linalg.lstsq(columns, steady.motion, rcond=None)[0]
    bent = fit_rest(steady.time, steady.motion, on.is_velocity, 0.0).again(columns, columns @ values, steady.motion)
    deviation = float(np.sqrt(bent.covariance[-1, -1]))
    change = float(values[-1]) * float(np.ptp(steady.time)) * (1.0 if on.is_velocity else 2.0)
    if abs(float(values[-1])) <= DECISIVE**0.5 * deviation:
        return speed
    return Estimate(speed.value, float(np.hypot(speed.reach, 0.5 * change)))


def _blurred(estimate: Estimate, resolution: float) -> Estimate:
    """An instant since the command's change, which is known to within some time only."""
    return Estimate(estimate.value, float(np.hypot(estimate.reach, 1.96 * resolution / 12.0**0.5)))


def least_variance(records: Sequence[Record]) -> float:
    """What the sensor's resolution adds to any noise: a uniform error within the largest of the records' stairs."""
    resolved = max(_stair(record.motion) for record in records)
    largest = max(float(np.max(np.abs(record.motion))) for record in records)
    return max(resolved**2 / 12.0, (SMALLEST * largest) ** 2, SMALLEST**4)


def _stair(motion: Array) -> float:
    """The smallest step between two samples where the motion goes by steps of its sensor; else zero."""
    steps = np.abs(np.diff(motion))
    moving = steps[steps > 0.0]
    return float(np.min(moving)) if moving.size and moving.size < 0.5 * steps.size else 0.0


def _drawn(on: Part, fit: Fit | None) -> tuple[Array, Array, Array]:
    return on.time, on.motion, fit.curve if fit is not None else np.full(on.time.size, np.nan)
