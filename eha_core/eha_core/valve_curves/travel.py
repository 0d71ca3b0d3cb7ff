"""The direction in which a command travels through a curve, and the play that a spool follows it with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eha_core.valve_curves.result import Array

AMMETER = 0.02
"""Share of the command's range that is more than the noise of an ammeter and less than any sweep: by so much it must
turn back for a new leg to begin, and the flow must stay flat to be saturated (assumed)."""


@dataclass(frozen=True)
class Travel:
    """How a command came to each point.

    Attributes:
        direction: 1 where it rises, -1 where it falls.
        turned: the command at which it last turned; NaN on the first leg.
    """

    direction: Array
    turned: Array

    @property
    def is_both_ways(self) -> bool:
        """Whether each direction was measured at a quarter of the points at least."""
        rising = float(np.mean(self.direction > 0.0))
        return 0.25 <= rising <= 0.75


def travel_of(command: Array) -> Travel:
    """The legs of a command in the order of its points."""
    least = AMMETER * float(np.ptp(command))
    turns: list[int] = []  # the first point of each leg but the first
    low = high = 0
    heading = 0
    for k, value in enumerate(command):
        low = k if value <= command[low] else low
        high = k if value >= command[high] else high
        if heading <= 0 and value - command[low] > least:
            if heading:
                turns.append(low)
            heading, high = 1, k
        elif heading >= 0 and command[high] - value > least:
            if heading:
                turns.append(high)
            heading, low = -1, k
    direction, turned = np.empty(command.size), np.full(command.size, np.nan)
    ends = [*turns, command.size]
    sign = heading * (-1) ** len(turns)
    begin = 0
    for count, end in enumerate(ends):
        direction[begin:end] = sign * (-1) ** count
        if count:
            turned[begin:end] = command[begin]
        begin = end
    return Travel(direction, turned)


def behind_play(command: Array, travel: Travel, half_width: float) -> Array:
    """What follows the command past a play: lower by the half width where it rises, higher where it falls, held after
    a turn until the play is crossed (the law of the effect `spool_hysteresis`)."""
    dragged = command - travel.direction * half_width
    held = np.where(np.isnan(travel.turned), dragged, travel.turned + travel.direction * half_width)
    return np.where(travel.direction > 0.0, np.maximum(dragged, held), np.minimum(dragged, held))
