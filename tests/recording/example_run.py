"""A run in closed form, and the topics file that reads it back from each kind of log file."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[2] / "examples"))

from log_files import KINDS, Run

COUNT, PERIOD = 400, 1e-3
TIME = np.arange(COUNT) * PERIOD
_TURN = 2.0 * np.pi * 5.0 * TIME
VOLTAGE, POSITION = 0.05 * np.sin(_TURN), 0.02 * (1.0 - np.cos(_TURN))
RUN = Run(TIME, VOLTAGE, POSITION, 8e6 + 2e6 * np.cos(_TURN), 9e6 - 2e6 * np.cos(_TURN))
CHANNELS = {
    "voltage_command": VOLTAGE, "position": POSITION, "pressure_a": RUN.pressure_a, "pressure_b": RUN.pressure_b
}  # fmt: skip


def _channels(time: str, voltage: str, position: str, pressure_a: str, pressure_b: str) -> str:
    columns = {
        "time": time, "voltage_command": voltage, "position": position, "pressure_a": pressure_a,
        "pressure_b": pressure_b,
    }  # fmt: skip
    units = {"position": ", unit: mm", "pressure_a": ", unit: barg", "pressure_b": ", unit: barg"}
    return "channels:\n" + "".join(
        f'  {name}: {{column: "{column}"{units.get(name, "")}}}\n' for name, column in columns.items()
    )


TOPICS = {
    "semicolons": _channels("Zeit [ms]", "u [V]", "x [mm]", "pA [bar]", "pB [bar]"),
    "tabs": _channels("stamp", "u_valve", "x_piston", "p_head", "p_rod"),
    "dates": _channels("timestamp", "u_V", "x_mm", "pA_bar", "pB_bar"),
    "labview": _channels("X_Value", "valve", "piston position", "pressure A", "pressure B"),
    "control_desk": _channels("Time", "u", "x", "pA", "pB"),
    "without_names": _channels("column 1", "column 2", "column 3", "column 4", "column 5"),
    "mat_5": _channels("run1.X.Time", "run1.Y.u", "run1.Y.x", "run1.Y.pA", "run1.Y.pB"),
    "mat_73": _channels("t", "u_V", "x_mm", "p_A_Pa", "p_B_Pa").replace("unit: barg", "reference: gauge"),
    "parquet": "channels:\n  time: {column: timestamp}\n",
}


def written(folder: Path, kind: str) -> tuple[Path, Path]:
    """A log file of a kind and the topics file that reads it."""
    name, write = KINDS[kind]
    write(folder / name, RUN)
    topics = folder / "topics.yaml"
    topics.write_text(TOPICS[kind])
    return folder / name, topics
