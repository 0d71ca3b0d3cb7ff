"""Characteristic scales of a recording's motion, computed once, for the catalogue's initial guesses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eha_core.identification.fit import Fit
from eha_core.identification.numbers import Array
from eha_core.identification.observation import WITH_OIL, Observation
from eha_core.identification.segments import smooth
from eha_core.identification.shooting import Shooting
from eha_core.plant import COLUMNS

QUANTITIES = ("position", "time", "speed", "force", "spool", "pressure", "supply_flow", "leakage_flow")
"""The quantities that an initial guess can be relative to."""


@dataclass(frozen=True)
class Scales:
    """Origin and scale of each of QUANTITIES, and the calibrated model's states over time (rows of COLUMNS, each a
    sample)."""

    by_quantity: Mapping[str, tuple[float, float]]
    rows: Array

    def column(self, name: str) -> Array:
        """One column of the calibrated model's rows."""
        return self.rows[:, COLUMNS.index(name)]


def characteristic_scales(observations: Sequence[Observation], shooting: Shooting, calibrated: Fit) -> Scales:
    """The scales of the measured positions and of one full simulation of the calibrated model."""
    positions = [
        channel for observation in observations for channel in observation.measured if channel.name == "position"
    ]
    low, high = np.quantile(np.concatenate([channel.values for channel in positions]), [0.002, 0.998])
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    speed = float(np.std(np.concatenate([smooth(channel, 1) for channel in positions])))
    by_quantity = {
        "position": (float(centre), float(half)),
        "time": (0.0, max(observation.duration for observation in observations)),
        "speed": (0.0, speed),
    }
    if shooting.drive in WITH_OIL:
        rows, _ = shooting.simulate(calibrated.values, calibrated.states, full=True)
        area = calibrated.values["piston_area"]
        difference = rows[:, COLUMNS.index("pressure_a")] - rows[:, COLUMNS.index("pressure_b")]
        pressure = float(np.std(difference))
        flow = float(np.std(rows[:, COLUMNS.index("flow_a")]))
        by_quantity["force"] = (0.0, area * pressure + calibrated.values["damping_coefficient"] * speed)
        by_quantity["spool"] = (0.0, float(np.std(rows[:, COLUMNS.index("spool_position")])))
        by_quantity["pressure"] = (0.0, max(pressure, 0.01 * calibrated.values["supply_pressure"]))
        by_quantity["supply_flow"] = (0.0, calibrated.values["supply_pressure"] / flow)
        by_quantity["leakage_flow"] = (0.0, flow / max(pressure, 1e5))
    else:
        rows = np.empty((0, len(COLUMNS)))
        drive = calibrated.values["piston_area"] * (shooting.inputs[0] - shooting.inputs[1])
        by_quantity["force"] = (0.0, float(np.std(drive)))
    return Scales(by_quantity, rows)


def scales_alone(shooting: Shooting, scales: Scales, number: int) -> Scales:
    """The scales with the calibrated model's states in one recording only."""
    if not len(scales.rows) or len(shooting.first_windows) == 1:
        return scales
    windows = shooting.recordings[number - 1]
    begin, end = (int(shooting.edges[window]) // shooting.every for window in (windows.start, windows.stop))
    return replace(scales, rows=scales.rows[begin:end])
