"""The measured and the modelled channels as one MCAP for PlotJuggler, Foxglove and `ros2 bag play`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.identification.numbers import Array
from eha_core.parameters import nominal_values
from eha_core.recording.message_rows import encode_rows
from eha_core.report.whole_topics import Topic, write_topics

JOINTS, PRESSURE = "sensor_msgs/msg/JointState", "sensor_msgs/msg/FluidPressure"
FLOAT = "std_msgs/msg/Float64"
_PRESSURE_TOPICS = {"pressure_a": "chamber_a/pressure", "pressure_b": "chamber_b/pressure"}


def write_comparison(diagnosis: Diagnosis, path: Path) -> int:
    """Write /measured, /nominal, /recalibrated and /augmented with the simulator's topics below each, and /residual
    with measured minus augmented as plain numbers; return the number of messages.

    Stamps are the recording's own, so that both files share one time axis. Pressures are absolute, as their message
    defines them.

    Raises:
        RecordingError: the file exists already or cannot be written.
    """
    pictures = diagnosis.pictures
    atmosphere = {**nominal_values(), **diagnosis.fitted_values}["atmospheric_pressure"]
    sources = {
        "measured": pictures.measured,
        "nominal": pictures.before,
        "recalibrated": pictures.calibrated,
        "augmented": pictures.after,
    }
    topics = [
        topic
        for source, series in sources.items()
        for topic in _topics(f"/{source}", series, pictures.time, diagnosis.start_stamp, atmosphere)
    ]
    topics += _residuals(pictures.measured, pictures.after, pictures.time, diagnosis.start_stamp)
    return write_topics(path, topics, diagnosis.fitted_values)


def _topics(
    source: str, series: Mapping[str, Array], time: Mapping[str, Array], start: int, atmosphere: float
) -> Iterator[Topic]:
    for name, values in series.items():
        stamps = start + np.round(1e9 * time[name]).astype(np.int64)
        if name == "position":
            motion = {"position": values}
            if "velocity" in series:
                motion["velocity"] = np.interp(time[name], time["velocity"], series["velocity"])
            data = encode_rows(JOINTS, motion, stamps, name=["piston"])
            yield Topic(f"{source}/joint_states", JOINTS, stamps, data)
        elif name in _PRESSURE_TOPICS:
            data = encode_rows(PRESSURE, {"fluid_pressure": values + atmosphere}, stamps)
            yield Topic(f"{source}/{_PRESSURE_TOPICS[name]}", PRESSURE, stamps, data)
        elif name != "velocity":
            yield Topic(f"{source}/{name}", FLOAT, stamps, encode_rows(FLOAT, {"data": values}))


def _residuals(
    measured: Mapping[str, Array], modelled: Mapping[str, Array], time: Mapping[str, Array], start: int
) -> Iterator[Topic]:
    for name, values in modelled.items():
        stamps = start + np.round(1e9 * time[name]).astype(np.int64)
        rows = encode_rows(FLOAT, {"data": measured[name] - values})
        yield Topic(f"/residual/{name}", FLOAT, stamps, rows)
