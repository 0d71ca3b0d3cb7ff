"""Small recordings for these tests, written by the library or by other hands."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from eha_core.recording import RecordingWriter

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
ATMOSPHERE = 101325.0


def header(stamp: int) -> dict[str, dict[str, int]]:
    return {"stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND}}


def write_piston(
    writer: RecordingWriter,
    count: int = 100,
    period: int = SECOND // 100,
    namespace: str = "",
    topics: Iterable[str] = ("voltage_command", "joint_states", "chamber_a/pressure", "chamber_b/pressure"),
    start: int = START,
) -> None:
    """Sample k: voltage k mV, position k um, velocity k mm/s, effort k N, model pressures 1e6 + k and 2e6 + k Pa."""
    for k in range(count):
        stamp = start + k * period
        messages = {
            "voltage_command": ("std_msgs/msg/Float64", {"data": k * 1e-3}),
            "joint_states": (
                "sensor_msgs/msg/JointState",
                {
                    "header": header(stamp),
                    "name": ["piston"],
                    "position": [k * 1e-6],
                    "velocity": [k * 1e-3],
                    "effort": [float(k)],
                },
            ),
            "chamber_a/pressure": (
                "sensor_msgs/msg/FluidPressure",
                {"header": header(stamp), "fluid_pressure": 1e6 + k + ATMOSPHERE},
            ),
            "chamber_b/pressure": (
                "sensor_msgs/msg/FluidPressure",
                {"header": header(stamp), "fluid_pressure": 2e6 + k + ATMOSPHERE},
            ),
        }
        for topic in topics:
            writer.write_fields(f"{namespace}/{topic}", *messages[topic], stamp)


def piston_recording(path: Path, **how: object) -> Path:
    with RecordingWriter(path) as writer:
        write_piston(writer, **how)  # type: ignore[arg-type]
    return path
