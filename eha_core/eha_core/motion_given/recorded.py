"""What recording did to the force: an average that its spectrum proves is named, a delay is said to be possible."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from eha_core.diagnosis.result import FittedValue, NamedEffect
from eha_core.motion_given.law import Law, Regression, held_out_errors, predict, solve
from eha_core.motion_given.motion import Array, Motion
from eha_core.motion_given.search import WORTH
from eha_core.motion_given.terms import moving_average
from eha_core.quantities import quantity

AGREE = 0.05
"""Share by which windows may differ and still be one: a window is whole samples and a period known to 2 %."""

REACH = np.linspace(-0.3, 0.3, 61)
"""Delays that are tried, in units of the motion's own time, the deviation of position over that of speed: a twentieth
of a sine's period to either side (assumed)."""

WINDOWS = (0.2, 0.4, 0.8, 1.6)
"""Windows of averages that are tried, in the same unit: from 0.03 to 0.25 of a sine's period (assumed)."""


def averaging(motions: Sequence[Motion], law: Law) -> NamedEffect | None:
    """The moving average that the forces went through; None where no spectrum shows one."""
    averaged = [motion for motion in motions if motion.averaged is not None]
    if not averaged:
        return None
    window, parameters = _window(averaged)
    some = "" if len(averaged) == len(motions) else f" in {len(averaged)} of {len(motions)} recordings"
    too = ", and so is the position" if all(motion.position_averaged == motion.averaged for motion in averaged) else ""
    plain = Regression.of([replace(motion, averaged=None) for motion in motions])
    with_it = held_out_errors(Regression.of(motions), law.terms, law.shape)
    without = held_out_errors(plain, law.terms, law.shape)
    return NamedEffect(
        id="smoothed_force",
        site="sensor",
        equation="F recorded = mean of F over the window",
        parameters=parameters,
        evidence=float(len(with_it) * np.log(np.mean(without) / np.mean(with_it))),
        statement=f"the recorded force is a moving average over {window}{some}{too}: its spectrum has the zeros of one",
        kind="smoothing",
    )


def _window(averaged: Sequence[Motion]) -> tuple[str, dict[str, FittedValue]]:
    """The window in words and as a value: one time, one share of the period, or each recording's own time."""
    seconds = np.array([motion.averaged for motion in averaged], dtype=np.float64)
    step = max(motion.step for motion in averaged)
    rounding = 1.0 / np.sqrt(12.0)
    if np.ptp(seconds) < AGREE * seconds.max():
        found = float(seconds.mean())
        return quantity(found, "s"), {"window": FittedValue(found, step * rounding, "s")}
    shares = np.array([motion.averaged / motion.period for motion in averaged if motion.averaged and motion.period])
    if len(shares) == len(seconds) and np.ptp(shares) < AGREE * shares.max():
        found = float(shares.mean())
        deviation = max(motion.step / motion.period for motion in averaged if motion.period) * rounding
        return f"{found:.3f} of the motion's period", {"share": FittedValue(found, float(deviation), "-")}
    named = {
        f"window of recording {place}": FittedValue(float(motion.averaged or 0.0), step * rounding, "s")
        for place, motion in enumerate(averaged, 1)
    }
    windows = zip(named.values(), averaged, strict=True)
    return " and ".join(f"{quantity(one.value, 's')} ({motion.name})" for one, motion in windows), named


def possible_timing(motions: Sequence[Motion], law: Law) -> list[str]:
    """A remark on each recording whose force a delay or an average would bring nearer to its law, as a possibility.

    A residual says that the force turns round earlier, later or more slowly than the law, not why. Averages are only
    named where a spectrum proves them.
    """
    if not law.terms or (len(motions) > 1 and not law.holds):
        return []
    periods = [motion.period for motion in motions if motion.period is not None]
    several = len(periods) > 1 and max(periods) - min(periods) > AGREE * max(periods)
    tell = (
        "an equal time in recordings of another frequency would point to the recording, any other to the rig"
        if several
        else "a second recording at another frequency would tell"
    )
    return [f"{timing}; {tell}" for motion in motions for timing in _timing(motion, law)]


def _timing(motion: Motion, law: Law) -> Iterator[str]:
    unit = float(np.std(motion.position) / np.std(motion.velocity))
    force = predict(law, motion)
    left = _square(force, motion)
    delay = min(REACH * unit, key=lambda late: _delayed(force, motion, late))
    window = min((unit * share for share in WINDOWS), key=lambda one: _rounded(force, motion, one))
    if _delayed(force, motion, delay) < (1.0 - WORTH) * left:
        yield (
            f"{motion.name}: the force reverses {quantity(abs(delay), 's')} {'after' if delay > 0.0 else 'before'} the"
            " law does; this may be compliance in series, a trapped gas, hysteresis of another form"
            f"{'' if motion.averaged is None else ', an average over past samples only'} or a delay between the"
            " channels"
        )
    elif motion.averaged is None and _rounded(force, motion, window) < (1.0 - WORTH) * left:
        yield (
            f"{motion.name}: the force turns round more slowly than the law, as if averaged over"
            f" {quantity(window, 's', 2)}, but its spectrum does not show an average of samples; this may be compliance"
            " in series, hysteresis of another form or an analogue filter"
        )


def _delayed(force: Array, motion: Motion, late: float) -> float:
    return _square(np.interp(motion.time - late, motion.time, force), motion)


def _rounded(force: Array, motion: Motion, window: float) -> float:
    return _square(moving_average(force, max(1.0, window / motion.step)), motion)


def _square(force: Array, motion: Motion) -> float:
    """The mean squared residual of a force, whose height and offset are fitted anew."""
    columns = np.stack([force, np.ones_like(force)], axis=1)[motion.used]
    return float(np.mean((columns @ solve(columns, motion.force[motion.used]) - motion.force[motion.used]) ** 2))
