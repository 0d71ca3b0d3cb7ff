"""Coefficients that depend on a further recorded quantity: a coil's current, a temperature, a pilot pressure.

Each has a value at some levels of the schedule and is linear between them, so its shape needs no formula: with the two
ends it is base + slope s, with more it is any function, and one that grows throughout is reported as such. Beyond the
levels the value at the nearest applies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eha_core.motion_given.motion import Array, Motion
from eha_core.motion_given.terms import TERMS, Term

MOST_LEVELS = 5
"""Levels of the schedule at most (assumed): a saturating curve is within 3 % of its chords."""

NEARLY = 0.01
"""Share of the schedule's range that makes no difference: levels are rounded within it (assumed)."""

FRICTION = ("viscous friction", "quadratic damping", "dry friction")
"""Kinds of terms that may depend on the schedule."""


def scheduled_terms(motions: Sequence[Motion], most: int) -> tuple[Term, ...]:
    """The friction terms as functions of the schedule, with so many levels at most; none without one that varies."""
    recorded = [motion.schedule[motion.used] for motion in motions if motion.schedule is not None]
    if len(recorded) < len(motions):
        return ()
    levels = levels_of(np.concatenate(recorded), most)
    if len(levels) < 2:
        return ()
    return tuple(_over(term, levels, motions[0].schedule_name) for term in TERMS if term.kind in FRICTION)


def levels_of(values: Array, most: int) -> tuple[float, ...]:
    """The values that occur where they are few, else as many quantiles, the ends among them, rounded to be read."""
    distinct = np.unique(values)
    if len(distinct) > most:
        grid = 10.0 ** np.floor(np.log10(NEARLY * np.ptp(distinct)))
        distinct = np.unique(np.round(np.quantile(distinct, np.linspace(0.0, 1.0, most)) / grid) * grid)
    return tuple(float(f"{value:.9g}") for value in distinct)


def _over(term: Term, levels: tuple[float, ...], schedule: str) -> Term:
    def columns(motion: Motion, dry: Array, shape: tuple[float, ...]) -> list[Array]:
        assert motion.schedule is not None
        shares = [np.interp(motion.schedule, levels, unit) for unit in np.eye(len(levels))]
        return [column * share for column in term.columns(motion, dry, shape) for share in shares]

    sizes = tuple((f"{name} at {level:g}", unit) for name, unit in term.sizes for level in levels)
    return replace(
        term,
        sizes=sizes,
        columns=columns,
        levels=levels,
        schedule=schedule,
        equation=f"{term.equation}, with sizes that are functions of {schedule}",
    )


def schedule_remarks(motions: Sequence[Motion], tests: Sequence[Motion], terms: Sequence[Term]) -> list[str]:
    """Where a schedule is not in all recordings, does not vary or changes nothing, and where a test is beyond it."""
    there = [motion for motion in motions if motion.schedule is not None]
    if not there:
        return []
    name = there[0].schedule_name
    if len(there) < len(motions):
        return [f"{name} was left out, because {len(there)} of {len(motions)} recordings have it"]
    values = np.concatenate([np.asarray(motion.schedule)[motion.used] for motion in there])
    if not np.ptp(values) > 0.0:
        return [f"{name} is {values[0]:g} throughout, so that no coefficient can be seen to depend on it"]
    levels = next((term.levels for term in terms if term.levels), None)
    if levels is None:
        return [f"no coefficient was found to depend on {name}, from {values.min():.3g} to {values.max():.3g}"]
    low, high = levels[0], levels[-1]
    margin = NEARLY * (high - low)
    return [
        f"{test.name}: {name} is beyond {low:g} to {high:g}, where the law was found; its nearest values were taken"
        for test in tests
        if test.schedule is not None and np.any(np.abs(test.schedule - np.clip(test.schedule, low, high)) > margin)
    ]
