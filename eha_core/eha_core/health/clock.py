"""Whether the position's clock runs at the same rate as the command's.

Two loggers whose clocks differ by two per cent are 0.2 s apart after ten seconds, which biases every law fitted between
their channels. The speed lags behind the command; here this delay is measured in pieces of the recording. A rig's own
delay may change, by wear or with the amplitude, but by some hundredths of a second, and not at a steady rate. A wrong
clock that all channels share cannot be seen here: it scales all parameters with a time in their unit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import theilslopes

from eha_core.health.fault import Fault
from eha_core.health.noise import NORMAL_MEDIAN
from eha_core.recording import Recording
from eha_core.recording.recording import FloatArray

PIECE, EVERY = 2.0, 1.0
"""s; length of a piece, and distance from one to the next: some reversals of a test (assumed)."""
TICK = 0.005
"""s; step of the grid on which both are compared: a peak's place is known to a tenth of it."""
LATEST = 0.3
"""s; largest delay or lead of the speed in a piece."""
ALIKE = 0.7
"""Smallest correlation of a piece with a known delay: the command explains half of the speed's variance."""
FEWEST = 5
"""Fewest pieces with a known delay."""
OUTSIDE = 3.0
"""Deviation from a straight line through the delays (by Theil and Sen), in units of their scatter about it (from the
median deviation), above which a delay is not used (assumed)."""
STEADY = 0.15
"""Largest RMS deviation from the line through the others, as a share of the line's rise, of a steady change: that of a
delay which leaps once is a quarter."""
DRIFTED = 0.07
"""s; smallest change of the delay. A rig's own changes by up to 0.05 s while a test's frequency or amplitude changes
steadily (three of 500 simulated rigs); a clock that is 2 % off reaches it within FEWEST pieces."""
SLOWEST = 0.003
"""Smallest difference of the rates that is reported; a logger's own crystal is off by a hundredth of that."""


def drift(recording: Recording) -> Sequence[Fault]:
    """A fault of the position, where its delay behind the command changes at a steady rate; empty without one."""
    command, position = (recording.channels.get(name) for name in ("voltage_command", "position"))
    if command is None or position is None or min(len(command.time), len(position.time)) < 100:
        return ()
    if not (np.ptp(command.values) > 0.0 and np.ptp(position.values) > 0.0):
        return ()
    grid = np.arange(max(command.time[0], position.time[0]), min(command.time[-1], position.time[-1]), TICK)
    if len(grid) * TICK < PIECE + (FEWEST - 1) * EVERY:
        return ()
    voltage = np.interp(grid, command.time, command.values)
    speed = np.gradient(np.interp(grid, position.time, position.values), TICK)
    when, late = _delays(grid, _smooth(voltage), _smooth(speed))
    line = steady(when, late)
    if line is None:
        return ()
    rate, level = line
    fault = Fault(
        "position", "clock", float(position.time[0]), float(position.time[-1]),
        f"its clock runs {100.0 * abs(rate):.2g} % {'fast' if rate > 0.0 else 'slow'} compared with the command's:"
        f" its delay is {1e3 * (level + rate * when[0]):.0f} ms at the start and"
        f" {1e3 * (level + rate * when[-1]):.0f} ms at the end",
        "stamp all channels by one clock", False, True,
    )  # fmt: skip
    return (fault,)


def steady(when: FloatArray, late: FloatArray) -> tuple[float, float] | None:
    """The line, slope and value at time 0, along which the delays `late` [s] of pieces about the times `when` [s]
    change; None where they do not change at a steady rate."""
    if len(when) < FEWEST:
        return None
    # a piece of even oscillation may seem late by a period more or less
    about = late - float(theilslopes(late, when)[0]) * when
    apart = np.abs(about - np.median(about))
    kept = apart <= max(OUTSIDE * float(np.median(apart)) / NORMAL_MEDIAN, TICK)
    if np.count_nonzero(kept) < FEWEST:
        return None
    rate, level = np.polyfit(when[kept], late[kept], 1)
    left = float(np.std(late[kept] - rate * when[kept]))
    rise = abs(rate) * float(np.ptp(when))
    if abs(rate) < SLOWEST or rise < DRIFTED or left > STEADY * rise:
        return None
    return float(rate), float(level)


def _smooth(values: FloatArray) -> FloatArray:
    """Moving means over five ticks; above their frequencies the speed is noise."""
    return np.asarray(np.convolve(values, np.full(5, 0.2), mode="same"))


def _delays(grid: FloatArray, voltage: FloatArray, speed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The middles [s] of the pieces in which the speed follows the command, and its delays there [s]."""
    length, reach = round(PIECE / TICK), round(LATEST / TICK)
    when, late = [], []
    for first in range(reach, len(grid) - length - reach, round(EVERY / TICK)):
        piece = voltage[first : first + length]
        around = speed[first - reach : first + length + reach]
        alike = _correlations(piece, around)
        best = int(np.argmax(alike))
        if alike[best] < ALIKE or not 0 < best < len(alike) - 1:
            continue
        before, at, after = alike[best - 1 : best + 2]
        peak = best + 0.5 * (before - after) / min(before - 2.0 * at + after, -1e-12)
        when.append(grid[first] + 0.5 * PIECE)
        late.append((peak - reach) * TICK)
    return np.array(when), np.array(late)


def _correlations(piece: FloatArray, around: FloatArray) -> FloatArray:
    """Absolute correlation of a piece with each equally long piece of `around`: with reversed polarity the response has
    the other sign."""
    centred = piece - piece.mean()
    power = float(centred @ centred)
    if not power > 0.0:
        return np.zeros(len(around) - len(piece) + 1)
    together = np.correlate(around, centred, mode="valid")
    ones = np.ones(len(piece))
    total, square = np.correlate(around, ones, mode="valid"), np.correlate(around**2, ones, mode="valid")
    own = np.maximum(square - total**2 / len(piece), 1e-12 * float(np.max(square)) + 1e-300)
    return np.asarray(np.abs(together) / np.sqrt(power * own))
