"""All steps of one direction together: dead zone, gain, saturation, delay and end stop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eha_core.step_tests.line import SIGNIFICANT, Line, fit_line, mean_of
from eha_core.step_tests.result import Array, Direction, Estimate, Integers, Step
from eha_core.step_tests.saturation import straightness

SAME_LEVEL = 0.02
"""Share of the largest level by which steps of one level may differ (assumed)."""

SAME_PLACE = 0.01
"""Share of the whole travel by which steps that stop at one place may differ (assumed)."""

FARTHEST = 0.5
"""Share of the span of a line's levels by which it may be extended to the dead zone: where a valve begins to open, its
curve is often not straight (assumed)."""

FEWEST = 3
"""Fewest steps that show a line and how far they scatter about it."""


def directions_of(steps: Sequence[Step], is_velocity: bool) -> tuple[list[Step], list[Direction]]:
    """The steps with what only their neighbours show, and each direction's figures."""
    travel = _travel(steps)
    known, directions = list(steps), []
    for sign in (1, -1):
        places = [place for place, step in enumerate(steps) if step.sign == sign]
        if not places:
            continue
        mine, stop, reason = _end_stop([steps[place] for place in places], travel, is_velocity)
        directions.append(_direction(sign, mine, stop, reason))
        for place, step in zip(places, mine, strict=True):
            known[place] = step
    return known, directions


def _travel(steps: Sequence[Step]) -> float:
    places = [place for step in steps for place in step.places]
    return float(np.ptp(places)) if places else 0.0


def _end_stop(steps: list[Step], travel: float, is_velocity: bool) -> tuple[list[Step], Estimate | None, str]:
    """The steps, those marked that an end stop disturbs; the stop, or why it is open."""
    stopped = [step for step in steps if step.stopped_at is not None]
    if is_velocity:
        return steps, None, "a velocity shows no place; record the position"
    if not stopped:
        return steps, None, "no step was stopped before its command ended"
    ways = [step.places[1] - step.places[0] for step in steps if step.moved]
    way = 1.0 if float(np.median(ways)) > 0.0 else -1.0
    places = [step.stopped_at for step in stopped if step.stopped_at is not None]
    last = max(way * place.value for place in places)
    near = [place for place in places if last - way * place.value <= SAME_PLACE * travel]
    steps = [_beside(step, places, SAME_PLACE * travel) for step in steps]
    if len(near) > 1:
        return steps, mean_of(near), ""
    several = "one step" if len(places) == 1 else "each step"
    return steps, None, f"{several} stopped at a place of its own, perhaps at a hindrance; repeat the step up to there"


def _beside(step: Step, stops: Sequence[Estimate], room: float) -> Step:
    """A step without what a stop disturbs."""
    began, ended = (any(abs(place - stop.value) <= room for stop in stops) for place in step.places)
    if began and not step.moved:
        reason = "began where other steps were stopped; begin away from it"
        return replace(step, open=dict.fromkeys(step.open, reason) | {"level": reason})
    if ended and step.stopping is not None:
        reason = "the motion ended where other steps were stopped; end the command before"
        return replace(step, stopping=None, open=step.open | {"stopping": reason})
    return step


def _direction(sign: int, steps: list[Step], stop: Estimate | None, why_no_stop: str) -> Direction:
    counted = [step for step in steps if "level" not in step.open]
    groups = _groups(np.array([abs(step.level) for step in steps]))
    still = [abs(step.level) for step in counted if not step.moved]
    moving = [abs(step.level) for step in counted if step.moved]
    unseen = [step.unseen for step in counted if step.unseen is not None and abs(step.level) == max(still)]
    found = Direction(sign, len(steps), int(groups.max()) + 1, max(still, default=None), min(unseen, default=None),
                      min(moving, default=None), end_stop=stop)  # fmt: skip
    reasons, remarks = ({} if stop else {"end_stop": why_no_stop}), []
    if not moving:
        unclear = [step.open["level"] for step in steps if "level" in step.open]
        reason = "no step moved anything; step to larger levels" if still or not unclear else unclear[0]
        reasons |= dict.fromkeys(("dead_zone", "gain", "delay"), reason)
        return replace(found, open=reasons)
    if found.still is None:
        remarks.append("every step moved: below the smallest level nothing is known; step to smaller levels until"
                       " nothing moves")  # fmt: skip
    elif found.still > min(moving):
        remarks.append("a level that moved in one step did not in another; repeat steps of these levels, and see that"
                       " none begins at a stop")  # fmt: skip
    found = _with_delay(replace(found, open=reasons, remarks=tuple(remarks)), counted)
    return _with_line(found, counted)


def _groups(levels: Array) -> Integers:
    """The number of each step's level, the smallest 0."""
    order = np.argsort(levels)
    rises = np.diff(levels[order]) > SAME_LEVEL * float(np.max(levels))
    groups = np.empty(levels.size, dtype=np.int64)
    groups[order] = np.concatenate([[0], np.cumsum(rises)])
    return groups


def _with_delay(found: Direction, steps: list[Step]) -> Direction:
    """The mean delay, and its slope over the level where that is significant."""
    timed = [step for step in steps if step.delay is not None]
    if not timed:
        reason = next((step.open["delay"] for step in steps if step.moved and "delay" in step.open), "no step shows it")
        return replace(found, open=found.open | {"delay": reason})
    # what is not known of the command's instant is alike in all steps: a mean over many does not make it smaller
    common = 1.96 * max(step.resolution for step in timed) / 12.0**0.5
    own = [Estimate(step.delay.value, max(step.delay.reach**2 - common**2, 0.0) ** 0.5)
           for step in timed if step.delay is not None]  # fmt: skip
    mean, slope = mean_of(own), None
    mean = Estimate(mean.value, float(np.hypot(mean.reach, common)))
    levels = np.array([abs(step.level) for step in timed])
    if len(timed) > FEWEST and _groups(levels).max() > 1:
        line = fit_line([np.ones(levels.size), levels - levels.mean()], own)
        slope = line.estimate(1) if line.chance(1) < SIGNIFICANT else None
    return replace(found, delay=mean, delay_slope=slope)


def _with_line(found: Direction, steps: list[Step]) -> Direction:
    """Dead zone, gain and saturation, from the line of speed over level."""
    fast = [step for step in steps if step.speed is not None]
    speeds = [step.speed for step in fast if step.speed is not None]
    levels = np.array([abs(step.level) for step in fast])
    reason = _too_few(levels, speeds)
    if reason:
        return _without_line(found, reason)
    shown = straightness(levels, _groups(levels), speeds)
    if shown.is_bent:
        return _without_line(
            found, "the speed over the level is bent, not straight; step to more levels where motion begins, at least"
            " three close together"
        )  # fmt: skip
    on_line = [speed for speed, straight in zip(speeds, shown.straight, strict=True) if straight]
    levels = levels[shown.straight]
    if reason := _too_few(levels, on_line):
        return _without_line(found, f"{reason} below the saturation")
    line = fit_line([np.ones(levels.size), levels], on_line)
    gain = line.estimate(1)
    if line.chance(1) > SIGNIFICANT:
        return _without_line(found, "the speed does not surely rise with the level; step to levels farther apart")
    found = replace(found, gain=gain)
    if shown.limit is not None:
        found = _with_limit(found, line, shown.limit)
    return _with_dead_zone(found, line, levels)


def _too_few(levels: Array, speeds: list[Estimate]) -> str:
    """Why steady speeds show no line; empty where they do."""
    if not speeds:
        return "no step shows a steady speed; hold the command longer, or begin farther from the stop"
    if _groups(levels).max() == 0:
        return "steady speeds of one level only; step to three levels at least"
    if len({speed.value > 0.0 for speed in speeds}) > 1:
        return "steps of one direction moved both ways; look at the signs of the columns"
    return "two steady speeds show no scatter; repeat them, or step to a third level" if len(speeds) < FEWEST else ""


def _without_line(found: Direction, reason: str) -> Direction:
    return replace(found, open=found.open | {"dead_zone": reason, "gain": reason})


def _with_limit(found: Direction, line: Line, limit: Estimate) -> Direction:
    start, gain = line.values
    level = (limit.value - start) / gain
    of_line = line.of(level, [-1.0 / gain, -level / gain]).reach
    return replace(found, saturation=limit, knee=Estimate(level, float(np.hypot(of_line, limit.reach / gain))))


def _with_dead_zone(found: Direction, line: Line, levels: Array) -> Direction:
    """The level at which the line begins, where it does not contradict the steps without motion."""
    start, gain = line.values
    level = float(-start / gain)
    zone = line.of(level, [-1.0 / gain, -level / gain])
    low, high = zone.value - zone.reach, zone.value + zone.reach
    below, above = found.still or 0.0, found.moving or np.inf
    if found.still is not None and found.still > above:  # neither end of the bracket is sure
        below, above = 0.0, max(found.still, above)
    if abs(start + gain * below) - line.of(0.0, [1.0, below]).reach <= (found.unseen or 0.0):
        below = 0.0  # by the line it may have moved there, too slowly to be seen
    if high < below or low > above:
        reason = (
            "the line of speed over level begins outside of what the single steps show, so it is bent where motion"
            " begins; step to more levels there"
        )
        return _without_line(replace(found, gain=None, saturation=None, knee=None), reason)
    if float(np.min(levels)) - level > FARTHEST * float(np.ptp(levels)):
        reason = "the smallest level with a steady speed is far from where the line begins; step to smaller levels"
        return replace(found, open=found.open | {"dead_zone": reason})
    return replace(found, dead_zone=zone)
