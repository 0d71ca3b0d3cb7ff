"""The command against the motion: what it must be made of, whatever physics is missing."""

from __future__ import annotations

import numpy as np

from eha_core.plausibility.regression import correlation, regression
from eha_core.plausibility.relation import Relation, Values, off_by, within
from eha_core.plausibility.signals import Signals
from eha_core.recording.recording import FloatArray

LATEST_MOTION = 0.1
"""s by which the piston may follow the command: coil, spool, delays and sensors' lags."""


def gain(nominal: Values) -> float:
    """Steady speed of the unloaded nominal piston per volt, the mean of both directions [m/(s V)]."""
    ratio = nominal["piston_area_b"] / nominal["piston_area"]
    roots = [np.sqrt(share / (1.0 + ratio**3) * nominal["supply_pressure"]) for share in (1.0, ratio)]
    return float(np.mean(roots)) * nominal["valve_gain"] / nominal["piston_area"] / nominal["coil_resistance"]


def command(signals: Signals, nominal: Values, force: FloatArray | None) -> list[Relation]:
    """The command against what it must be made of: the flow that moves the piston, and leakage under the force."""
    voltage = signals.channels.get("voltage_command")
    if voltage is None or not np.ptp(voltage) > 0.0:
        return []
    others = (force,) if force is not None else (signals.channels["position"], signals.acceleration)
    fits = []
    for delay in range(0, round(LATEST_MOTION / signals.step) + 1, max(1, round(0.01 / signals.step))):
        earlier, speed = voltage[: len(voltage) - delay], signals.speed[delay:]
        explained = regression(earlier, speed, *(other[delay:] for other in others))[1]
        # The slope on the speed alone: beside a force that goes with it, its own share is any.
        fits.append((explained, correlation(earlier, speed), float(regression(earlier, speed)[0][0])))
    explained, together, slope = max(fits)
    ratio = slope * gain(nominal)  # command per speed, over the nominal
    related = explained > 0.3 and abs(together) > 0.3
    return [
        Relation("command", explained, explained < 0.18, explained > 0.3, 0.0),
        Relation("command_scale", ratio, related and not within(ratio, 25.0), related and within(ratio, 12.0),
                 off_by(ratio) if related else 0.0),
    ]  # fmt: skip
