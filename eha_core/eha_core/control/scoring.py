"""How well a controller follows, what it spends, and how much it chatters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Score:
    """One run's figures.

    Attributes:
        rmse: root mean square of the position error [m].
        largest_error: largest absolute position error [m].
        energy: hydraulic energy drawn from the supply [J].
        chattering: total variation of the voltage over time [V/s]; what the reference itself asks for is in it.
    """

    rmse: float
    largest_error: float
    energy: float
    chattering: float


def score(error: Array, voltage: Array, flow_a: Array, flow_b: Array, supply_pressure: Array, period: float) -> Score:
    """Return the figures of a run sampled every `period` [s].

    Args:
        error: measured position minus reference [m].
        voltage: the command [V].
        flow_a: valve flow into chamber A [m^3/s].
        flow_b: valve flow out of chamber B [m^3/s].
        supply_pressure: at the valve [Pa].
    """
    drawn = np.maximum(flow_a, 0.0) + np.maximum(-flow_b, 0.0)
    return Score(
        rmse=float(np.sqrt(np.mean(np.square(error)))),
        largest_error=float(np.abs(error).max()),
        energy=float(np.sum(supply_pressure * drawn) * period),
        chattering=float(np.abs(np.diff(voltage)).sum() / (len(voltage) * period)),
    )
