"""The relation of the command to the motion that holds whatever physics is missing."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eha_core.plausibility.regression import correlation, regression
from eha_core.plausibility.relation import Relation, Values, off_by, within
from eha_core.plausibility.signals import BLOCK, Signals
from eha_core.recording.recording import FloatArray

LATEST_MOTION = 0.1
"""s; largest delay of the piston behind the command: coil, spool, dead times and sensors' lags."""
LEAST_TAKEN = 0.024
"""Range of the speed, as a share of the rated one, from which the command must show in it. With less, the piston may
creep under leaks while an overlapped valve blocks any command (assumed: by 1 % of the rated speed)."""
RELATED = 0.25
"""Share of the command that the motion must explain if the command drove it: at least 0.50 in 750 sound recordings with
so much motion, 0.29 with an overlap of a quarter of the rated current; at most 0.24 with 120 commands of other runs."""
OTHER_MOMENTS = 20
"""Shifts of the command along the recording with which the recorded alignment is compared."""
OUTSTANDING = 2.0
"""Smallest ratio of the share that the motion explains of its own command to the largest with a shifted one, even with
a worn valve or under a load (assumed; commands of other runs reach at most 1.4)."""

Fit = tuple[float, float, float]
"""Share of the command that the motion explains, the command's correlation with the speed, its slope on it."""


def gain(nominal: Values) -> float:
    """Steady speed of the unloaded nominal piston per volt, the mean of both directions [m/(s V)]."""
    ratio = nominal["piston_area_b"] / nominal["piston_area"]
    roots = [np.sqrt(share / (1.0 + ratio**3) * nominal["supply_pressure"]) for share in (1.0, ratio)]
    return float(np.mean(roots)) * nominal["valve_gain"] / nominal["piston_area"] / nominal["coil_resistance"]


def rated(nominal: Values) -> float:
    """The command that saturates the valve's current [V]."""
    return nominal["saturation_current"] * nominal["coil_resistance"]


def command(signals: Signals, nominal: Values, force: FloatArray | None) -> list[Relation]:
    """The command compared with the flow that moves the piston and the leakage under the force.

    A command belongs to another run if the motion is too fast for creep, and explains hardly more of the command than
    of the same command shifted along the recording. Where friction allows less motion, the command may supply leaks of
    the same size, and its scale is wrong only beyond that.
    """
    voltage = signals.channels.get("voltage_command")
    if voltage is None or not np.ptp(voltage) > 0.0 or not signals.is_motion_seen:
        return []
    others = (force,) if force is not None else (signals.channels["position"], signals.acceleration)
    motion = (signals.speed, *others)
    explained, together, slope = max(_fits(voltage, motion, signals.step))
    ratio = slope * gain(nominal)  # command per speed, over the nominal
    related = explained > 0.3 and abs(together) > 0.3
    taken, least = float(np.ptp(signals.speed)), LEAST_TAKEN * gain(nominal) * rated(nominal)
    wrong = related and not within(ratio, 25.0 * max(1.0, least / taken))
    doubtful = taken > least and explained < RELATED
    foreign = doubtful and explained < OUTSTANDING * _elsewhere(voltage, motion, signals.step)
    return [
        Relation("command", explained, foreign, explained > 0.3, 0.0),
        Relation("command_scale", ratio, wrong, related and within(ratio, 12.0), off_by(ratio) if related else 0.0),
    ]


def _fits(voltage: FloatArray, motion: tuple[FloatArray, ...], step: float) -> Iterator[Fit]:
    """The fit of the command by the motion with each delay, over the whole recording and within blocks."""
    for delay in range(0, round(LATEST_MOTION / step) + 1, max(1, round(0.01 / step))):
        columns = voltage[: len(voltage) - delay], *(column[delay:] for column in motion)
        yield _fit(*columns)
        yield _fit(*_within_blocks(columns, step))


def _fit(voltage: FloatArray, speed: FloatArray, *others: FloatArray) -> Fit:
    explained = regression(voltage, speed, *others)[1]
    # The slope on the speed alone: together with a correlated force, its coefficient could be anything.
    together = correlation(voltage, speed)
    return explained, together, together * float(np.std(voltage) / (np.std(speed) + 1e-300))


def _within_blocks(columns: tuple[FloatArray, ...], step: float) -> tuple[FloatArray, ...]:
    """The columns minus their mean in each block, weighted so that the blocks count about equally in the first column.

    A leak that begins or a load that changes shifts the command by more than the motion does, but only within its own
    block.
    """
    count = max(1, round(len(columns[0]) * step / BLOCK))
    parts = [np.array_split(column, count) for column in columns]
    variances = np.array([np.var(part) for part in parts[0]])
    weights = 1.0 / np.sqrt(variances + np.median(variances) + 1e-300)
    return tuple(
        np.concatenate([weight * (part - part.mean()) for weight, part in zip(weights, column, strict=True)])
        for column in parts
    )


def _elsewhere(voltage: FloatArray, motion: tuple[FloatArray, ...], step: float) -> float:
    """The largest share of the command that the motion explains when the command is shifted cyclically.

    If a valve hardly opens, most of the command remains unexplained, but the rest is explained only when aligned.
    """
    shifts = np.linspace(0, len(voltage), OTHER_MOMENTS + 1)[1:-1].astype(int)
    shifted = [(np.roll(voltage, shift), *motion) for shift in shifts]
    views = [view for columns in shifted for view in (columns, _within_blocks(columns, step))]
    return max(regression(*view)[1] for view in views)
