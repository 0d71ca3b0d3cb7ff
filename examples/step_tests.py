"""Write step tests of the simulated actuator: a valve with a dead zone, a delay, and a stop inside the stroke.

python examples/step_tests.py out/step_tests
"""

from __future__ import annotations

import sys
from math import sqrt
from pathlib import Path

import numpy as np
import pandas as pd

import eha_core as eha
from eha_core.nominal import nominal_of

RATE, REST, HELD, LENGTH = 100.0, 1.0, 2.0, 4.0
"""Samples a second [Hz]; rest before the step, its length, and the record's [s]."""

VOLTS_PER_PERCENT = 1e-3
"""V; the amplifier's output for a duty of 1 % (assumed)."""

DUTIES = (5.0, 8.0, 12.0, 15.0, 20.0, 30.0, 40.0, 50.0)
"""%; each is stepped to once in both directions."""

DEAD_ZONE, DELAY, STOP = 10.0, 0.060, 0.040
"""%, s and m; what the steps shall show."""


def machine() -> dict[str, float]:
    """What differs from the nominal actuator [SI]; no spring, so that the load is alike at every place."""
    resistance = nominal_of({}).values["coil_resistance"]
    return {
        "spring_stiffness": 0.0,
        "damping_coefficient": 0.0,
        "internal_leakage": 0.0,
        "valve_deadband.half_width": DEAD_ZONE * VOLTS_PER_PERCENT / resistance,
        "command_delay.delay": DELAY,
        "end_stop.upper": STOP,
        "end_stop.stiffness": 1e9,
        "end_stop.damping": 1e5,
    }


def gain() -> float:
    """The speed that 1 % more gives, by the orifices' law without load [mm/s per %]."""
    values = nominal_of({}).values
    drop = 0.5 * (values["supply_pressure"] - values["return_pressure"])
    flow = values["valve_gain"] * sqrt(drop) * VOLTS_PER_PERCENT / values["coil_resistance"]
    return 1e3 * flow / values["piston_area"]


def write(folder: Path) -> None:
    """Write one table for each step."""
    folder.mkdir(parents=True, exist_ok=True)
    time = np.arange(0.0, LENGTH, 1.0 / RATE)
    held = (time >= REST) & (time < REST + HELD)
    for seed, duty in enumerate([sign * duty for sign in (1.0, -1.0) for duty in DUTIES], start=1):
        command = np.where(held, duty, 0.0)
        run = eha.simulate(command * VOLTS_PER_PERCENT, parameters=machine(), rate=RATE, noise=5.0, seed=seed)
        found = run.to_dict()
        rows = {
            "time [s]": found["time"],
            "duty [%]": found["voltage_command"] / VOLTS_PER_PERCENT,
            "position [mm]": 1e3 * found["position"],
        }
        pd.DataFrame(rows).to_csv(folder / f"step_{seed:02d}.csv", index=False, float_format="%.4f")


if __name__ == "__main__":
    write(Path(sys.argv[1] if len(sys.argv) > 1 else "out/step_tests"))
    print(
        f"dead zone {DEAD_ZONE:g} %, gain {gain():.4f} mm/s per %, delay {1e3 * DELAY:g} ms, stop at {1e3 * STOP:g} mm"
    )
