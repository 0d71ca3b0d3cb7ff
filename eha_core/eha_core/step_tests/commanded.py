"""Finds the steps of a command: from neutral to a constant level and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.step_tests.result import Array, Flags, Record

SMALLEST = 0.02
"""Share of a record's largest command from which it counts as not neutral (assumed)."""

OUTSIDE_NOISE = 6.0
"""Standard deviations of the command's noise at rest from which it counts as not neutral (assumed)."""

FLAT = 0.1
"""Share of the level by which the command may depart from it, and of the step's length that it may take to change; with
more it is a ramp or a sweep (assumed)."""

MOSTLY = 0.95
"""Share of a step's samples that must be flat (assumed)."""

REST = 0.1
"""s; what a record must at least begin with at neutral (assumed)."""

FEWEST = 5
"""Fewest samples of anything that is measured: a line and three to spare."""


@dataclass(frozen=True)
class Commanded:
    """A step of the command.

    Attributes:
        rest: instant from which the rest before it counts [s].
        on: instant of its change [s].
        off: instant of its going back; that of the last sample where it does not [s].
        until: instant up to which the motion after it counts [s].
        level: the command less neutral.
        resolution: time within which it changed [s].
        goes_back: whether it goes back to neutral within the record.
    """

    rest: float
    on: float
    off: float
    until: float
    level: float
    resolution: float
    goes_back: bool


def commanded_steps(record: Record) -> tuple[list[Commanded], list[str]]:
    """The steps of a record's command, and remarks on what is none."""
    held = _held(record)
    at_rest = max(int(np.searchsorted(record.time, record.time[0] + REST)), FEWEST)
    neutral = float(np.median(held[:at_rest]))
    away = held - neutral
    noise = 1.4826 * float(np.median(np.abs(away[:at_rest])))  # of a normal distribution, from the median
    largest = float(np.max(np.abs(away)))
    active = np.abs(away) > max(OUTSIDE_NOISE * noise, SMALLEST * largest)
    runs = [run for run in _runs(active) if run[1] - run[0] >= FEWEST and run[0] >= FEWEST]
    steps: list[Commanded] = []
    remarks = [] if runs else [
        f"{record.source}: the command does not step away from the {neutral:.4g} {record.command_unit} that it begins"
        " with; record from neutral on"
    ]  # fmt: skip
    for place, (first, last) in enumerate(runs):
        before = runs[place - 1][1] if place else 0
        after = runs[place + 1][0] if place + 1 < len(runs) else record.time.size - 1
        found = _step(record, away, noise, (before if place else -1, first, last, after))
        if isinstance(found, str):
            remarks.append(f"{record.source}, at {record.time[first]:.2f} s: {found}")
        else:
            steps.append(found)
    return steps, remarks


def _held(record: Record) -> Array:
    """The command in force at each sample of the motion."""
    last = np.searchsorted(record.command_time, record.time, side="right") - 1
    return record.command[np.clip(last, 0, None)]


def _runs(active: Flags) -> list[tuple[int, int]]:
    """First index and the one after the last of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], active, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _step(record: Record, away: Array, noise: float, places: tuple[int, int, int, int]) -> Commanded | str:
    """A step, or why a stretch of the command is none; `places` are where the one before ends, first, last, next."""
    before, first, last, after = places
    time, level = record.time, float(np.median(away[first:last]))
    near = np.abs(away[first:last] - level) <= FLAT * abs(level) + OUTSIDE_NOISE * noise
    length = float(time[last - 1] - time[first])
    places_near = np.flatnonzero(near)
    if not near.any() or np.mean(near[places_near[0] : places_near[-1] + 1]) < MOSTLY:
        return "the command is not constant between its change and its going back; step it from neutral to one level"
    risen, falls = first + int(places_near[0]), first + int(places_near[-1])
    if max(time[risen] - time[first], time[last - 1] - time[falls]) > FLAT * length:
        return "the command changes slowly; step it"
    on, resolution = _instant(record, first, risen)
    goes_back = last < time.size
    off = _instant(record, falls + 1, last)[0] if goes_back else float(time[-1])
    rest = 0.5 * float(time[before] + time[first]) if before >= 0 else float(time[0])
    return Commanded(rest, on, off, float(time[after]), level, resolution, goes_back)


def _instant(record: Record, first: int, last: int) -> tuple[float, float]:
    """The middle of the time within which the command changed, and that time's length [s]."""
    if record.has_own_times and first == last:
        place = int(np.searchsorted(record.command_time, record.time[first], side="right")) - 1
        return float(record.command_time[place]), 0.0
    early, late = float(record.time[first - 1]), float(record.time[last])
    return 0.5 * (early + late), late - early
