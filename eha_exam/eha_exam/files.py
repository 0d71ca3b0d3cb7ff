"""A case as files: the recording a user would have, and the sealed answer beside it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from eha_core.recording import RecordingWriter
from eha_exam.case import Arrays, Case

START = 1_700_000_000_000_000_000
"""ns; stamp of the first sample of every recording."""

FLOAT = "std_msgs/msg/Float64"
JOINTS = "sensor_msgs/msg/JointState"
PRESSURE = "sensor_msgs/msg/FluidPressure"


def recording_name(case: Case) -> str:
    """A file name that says nothing of what is concealed."""
    return f"recording-{case.seed:012x}.mcap"


def write_case(case: Case, arrays: Arrays, path: Path) -> None:
    """Write the recording of a case as MCAP, with the nominal parameters the diagnosis is given."""
    atmosphere = case.nominal["atmospheric_pressure"]
    messages = sorted(_messages(arrays, atmosphere), key=lambda message: message[0])
    with RecordingWriter(path, parameters=case.nominal, flush_period=60.0) as writer:
        for stamp, topic, kind, fields in messages:
            if kind != FLOAT:
                fields = fields | {"header": {"stamp": {"sec": stamp // 10**9, "nanosec": stamp % 10**9}}}
            writer.write_fields(topic, kind, fields, stamp)


def further_name(name: str, number: int) -> str:
    """The file name of a case's recording of that number, counted from one."""
    return name if number == 1 else name.replace(".mcap", f"-{number}.mcap")


def write_per_recording(names: Sequence[str], nominal: Mapping[str, float], path: Path) -> None:
    """Write the nominal file that a diagnosis of several recordings is given: it lists what differs between them."""
    document = {"eha_sim": {"ros__parameters": dict(nominal)}, "per_recording": list(names)}
    path.write_text(yaml.safe_dump(document), encoding="utf-8")


def _messages(arrays: Arrays, atmosphere: float) -> Iterator[tuple[int, str, str, dict[str, Any]]]:
    for channel, (time, values) in arrays.items():
        stamps = (START + np.round(time * 1e9).astype(np.int64)).tolist()
        for stamp, value in zip(stamps, values.tolist(), strict=True):
            if channel == "voltage_command":
                yield stamp, "voltage_command", FLOAT, {"data": value}
            elif channel == "position":
                yield stamp, "joint_states", JOINTS, {"name": ["piston"], "position": [value]}
            else:
                chamber = channel.removeprefix("pressure_")
                yield stamp, f"chamber_{chamber}/pressure", PRESSURE, {"fluid_pressure": value + atmosphere}


@dataclass(frozen=True)
class Seal:
    """What is published before the diagnosis starts: a digest for each answer, by the recording's name."""

    digests: Mapping[str, str]

    def holds(self, name: str, answer: str) -> bool:
        """Whether an opened answer is the one that was sealed."""
        return self.digests.get(name) == digest_of(answer)


def answer_text(case: Case) -> str:
    """The answer to a case as JSON text."""
    return json.dumps(asdict(case), indent=1)


def read_answer(text: str) -> Case:
    """The case that `answer_text` wrote."""
    fields = json.loads(text)
    fields["effects"] = tuple((name, values) for name, values in fields["effects"])
    fields["windows"] = {name: tuple(span) for name, span in fields["windows"].items()}
    for name in ("channels", "seen", "loads"):
        fields[name] = tuple(fields[name])
    return Case(**fields)


def digest_of(text: str) -> str:
    """SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()
