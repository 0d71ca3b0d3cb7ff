"""The measured recording and what two models make of it, as one MCAP for PlotJuggler, Foxglove and `ros2 bag play`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from heapq import merge
from math import inf
from pathlib import Path

import numpy as np

from eha_core.diagnosis.result import Diagnosis
from eha_core.identification.numbers import Array, Integers
from eha_core.parameters import nominal_values
from eha_core.recording import RecordingWriter
from eha_core.recording.message_rows import encode_rows

JOINTS, PRESSURE = "sensor_msgs/msg/JointState", "sensor_msgs/msg/FluidPressure"
FLOAT = "std_msgs/msg/Float64"
_PRESSURE_TOPICS = {"pressure_a": "chamber_a/pressure", "pressure_b": "chamber_b/pressure"}

Message = tuple[int, str, str, bytes]


def write_comparison(diagnosis: Diagnosis, path: Path) -> int:
    """Write /measured, /nominal, /recalibrated and /augmented with the simulator's topics below each, and /residual
    with measured less augmented as plain numbers; return the number of messages.

    Stamps are the recording's own, so the file lies beside it on one time axis. Pressures are absolute, as their
    message defines them.

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
    topics += list(_residuals(pictures.measured, pictures.after, pictures.time, diagnosis.start_stamp))
    with RecordingWriter(path, diagnosis.fitted_values, flush_period=inf) as writer:
        for stamp, topic, type_name, data in merge(*topics):
            writer.write(topic, type_name, data, stamp)
        return writer.message_count


def _topics(
    source: str, series: Mapping[str, Array], time: Mapping[str, Array], start: int, atmosphere: float
) -> Iterator[Iterator[Message]]:
    for name, values in series.items():
        stamps = start + np.round(1e9 * time[name]).astype(np.int64)
        if name == "position":
            motion = {"position": values}
            if "velocity" in series:
                motion["velocity"] = np.interp(time[name], time["velocity"], series["velocity"])
            data = encode_rows(JOINTS, motion, stamps, name=["piston"])
            yield _messages(f"{source}/joint_states", JOINTS, stamps, data)
        elif name in _PRESSURE_TOPICS:
            data = encode_rows(PRESSURE, {"fluid_pressure": values + atmosphere}, stamps)
            yield _messages(f"{source}/{_PRESSURE_TOPICS[name]}", PRESSURE, stamps, data)
        elif name != "velocity":
            yield _messages(f"{source}/{name}", FLOAT, stamps, encode_rows(FLOAT, {"data": values}))


def _residuals(
    measured: Mapping[str, Array], modelled: Mapping[str, Array], time: Mapping[str, Array], start: int
) -> Iterator[Iterator[Message]]:
    for name, values in modelled.items():
        stamps = start + np.round(1e9 * time[name]).astype(np.int64)
        rows = encode_rows(FLOAT, {"data": measured[name] - values})
        yield _messages(f"/residual/{name}", FLOAT, stamps, rows)


def _messages(topic: str, type_name: str, stamps: Integers, data: list[bytes]) -> Iterator[Message]:
    return ((stamp, topic, type_name, row) for stamp, row in zip(stamps.tolist(), data, strict=True))
