"""The valve in closed form: coil current, play and spool between two changes of the command are sums of exponentials.

With a constant voltage the current is I(t) = V/R + (I_0 - V/R) exp(-t R/L), held at the saturation current. It is
monotonic, so the play between current and spool target engages at most once and the current saturates at most once:
three pieces. On each the target is a + b exp(-t R/L), and a second-order spool's answer to it is known exactly.
A row of the table of pieces is (start, I_a, I_b, u_a, u_b, C, D): current I_a + I_b e, target u_a + u_b e and the
spool's own motion exp(-xi w t) (C cos w_d t + D sin w_d t), with e = exp(-t R/L) and t counted from the start.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

COLUMNS = 7


@njit(cache=True)
def evaluate(row, time, records):  # type: ignore[no-untyped-def]
    """Current [A], target [A], spool position [A] and spool rate [A/s] on one piece at an absolute time [s]."""
    p = records[0]
    rate = p.coil_resistance / p.coil_inductance
    frequency = p.valve_natural_frequency
    decay = p.valve_damping_ratio * frequency
    ringing = frequency * np.sqrt(1.0 - p.valve_damping_ratio**2)
    t = time - row[0]
    e = np.exp(-rate * t)
    answer = row[4] * frequency**2 / (rate**2 - 2.0 * decay * rate + frequency**2)
    c, s = np.cos(ringing * t), np.sin(ringing * t)
    envelope = np.exp(-decay * t)
    own = envelope * (row[5] * c + row[6] * s)
    own_rate = envelope * ((row[6] * ringing - decay * row[5]) * c - (row[5] * ringing + decay * row[6]) * s)
    spool = row[3] + answer * e + own
    return row[1] + row[2] * e, row[3] + row[4] * e, spool, own_rate - rate * answer * e


@njit(cache=True)
def _piece(row, start, current, target, spool, spool_rate, p):  # type: ignore[no-untyped-def]
    """Fill one row; `current` and `target` are (a, b) pairs."""
    rate = p.coil_resistance / p.coil_inductance
    frequency = p.valve_natural_frequency
    decay = p.valve_damping_ratio * frequency
    ringing = frequency * np.sqrt(1.0 - p.valve_damping_ratio**2)
    answer = target[1] * frequency**2 / (rate**2 - 2.0 * decay * rate + frequency**2)
    row[0] = start
    row[1], row[2] = current
    row[3], row[4] = target
    row[5] = spool - target[0] - answer
    row[6] = (spool_rate + rate * answer + decay * row[5]) / ringing


@njit(cache=True)
def extend(table, count, start, stop, voltage, state, records):  # type: ignore[no-untyped-def]
    """Append the pieces of one constant voltage over [start, stop] and advance `state` to the stop.

    `state` is (current, target, spool, spool rate). Returns the new number of rows; rows past it start at infinity.
    """
    p = records[0]
    rate = p.coil_resistance / p.coil_inductance
    half_width = p.spool_hysteresis_half_width
    limit = p.saturation_current
    final = voltage / p.coil_resistance
    while start < stop:
        current, target = state[0], state[1]
        drive = final - current
        direction = 1.0 if drive > 0.0 else -1.0
        saturated = abs(final) > limit and direction * current >= limit
        offset = direction * half_width
        engaged = direction * (current - offset - target) >= -1e-15
        end = stop
        if not saturated and abs(final) > limit:
            end = min(end, start + np.log(drive / (final - direction * limit)) / rate)
        if not saturated and not engaged:
            contact = target + offset
            if direction * (final - contact) > 0.0:
                end = min(end, start + np.log(drive / (final - contact)) / rate)
        end = max(end, start + 1e-12)
        currents = (current, 0.0) if saturated else (final, -drive)
        targets = (currents[0] - offset, currents[1]) if engaged and not saturated else (target, 0.0)
        row = table[count]
        _piece(row, start, currents, targets, state[2], state[3], p)
        count += 1
        state[0], _, state[2], state[3] = evaluate(row, end, records)
        state[0] = min(max(state[0], -limit), limit)
        state[1] = min(max(target, state[0] - half_width), state[0] + half_width)
        start = end
    return count


class Valve:
    """The valve's answer to a command that is held between samples; pieces are added as commands arrive."""

    def __init__(self, commands: int) -> None:
        self.table: NDArray[np.float64] = np.full((4 * commands + 16, COLUMNS), np.inf)
        self._count = 0
        self._state = np.zeros(4)

    def start(self, current: float, target: float, spool: float, spool_rate: float) -> None:
        """Begin from a state other than rest, before the first command."""
        self._state[:] = current, target, spool, spool_rate

    def command(self, start: float, stop: float, voltage: float, records: NDArray[np.void]) -> None:
        """Hold `voltage` [V] on the coil from `start` to `stop` [s]; the records in force are taken at the call."""
        if self._count + 8 > len(self.table):
            self.table = np.concatenate([self.table, np.full_like(self.table, np.inf)])
        self._count = extend(self.table, self._count, start, stop, voltage, self._state, records)
