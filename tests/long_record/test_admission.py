"""What of a long record is fitted where its actuator is not the paper's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.long_record import limits
from eha_core.long_record.admission import admitted
from eha_core.plant import Composition, compose
from eha_core.recording import Recording, RecordingWriter, read_recording
from eha_core.recording.message_types import encode

FLOAT = "std_msgs/msg/Float64"
FLOWS = {"source": "measured_flow"}
PUMP = {"source": "switched_pump", "cylinder": "single_rod"}
RATE, STRETCH, BLOCKS = 50.0, 2.0, 12
TIME = np.arange(round(RATE * STRETCH * BLOCKS)) / RATE


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "LONGEST_WHOLE", 10.0)
    monkeypatch.setattr(limits, "STRETCH", STRETCH)
    monkeypatch.setattr(limits, "STRETCHES", 3)


def moving(parts: Mapping[str, str], **channels: np.ndarray) -> Recording:
    """The piston to and fro, the same in every block, as a recorder that knows the actuator's parts keeps it."""
    position = 0.1 * np.sin(2.0 * np.pi * TIME / STRETCH)
    return replace(Recording.from_arrays(time=TIME, position=position, **channels), parts=parts)


@pytest.mark.parametrize(
    ("carried", "given"), [(FLOWS, None), ({}, compose("measured_flow")), ({"source": "servo_valve"}, compose(**FLOWS))]
)
def test_what_drives_is_what_the_parts_say(carried: Mapping[str, str], given: Composition | None) -> None:
    """A servo valve without a voltage, a force or pressures could not be looked at, and would be fitted as a whole."""
    flow = 1e-4 * np.cos(2.0 * np.pi * TIME / STRETCH)
    recording = moving(carried, flow_a=flow, flow_b=flow)
    record = admitted(recording, composition=given)
    assert len(record.recordings) == 3
    assert all(one.parts == carried for one in record.recordings)
    assert admitted(replace(recording, parts={})).recordings[0].duration == recording.duration


def test_the_stretch_in_which_a_pump_s_valve_switches_is_chosen() -> None:
    """The pump's speed, which comes first among what drives, tells nothing of it."""
    speed = 100.0 + np.sin(2.0 * np.pi * TIME / STRETCH)
    inside = (TIME >= 6.0) & (TIME < 8.0)
    sign = np.where(inside, 10.0 * np.round(1.4 * np.sin(9.0 * TIME)), 10.0)
    record = admitted(moving(PUMP, pump_speed=speed, voltage_command=sign))
    assert 3 in record.chosen
    steady = admitted(moving(PUMP, pump_speed=speed, voltage_command=np.full_like(TIME, 10.0)))
    assert 3 not in steady.chosen


def test_a_file_s_own_word_on_its_parts_is_taken(tmp_path: Path) -> None:
    path, topics = tmp_path / "run.mcap", tmp_path / "topics.yaml"
    with RecordingWriter(path, {"plant.source": "measured_current"}) as writer:
        for second in TIME:
            current = 0.01 * np.cos(2.0 * np.pi * second / STRETCH)
            values = {"/x": 0.1 * np.sin(2.0 * np.pi * second / STRETCH), "/i": current}
            for topic, value in values.items():
                writer.write(topic, FLOAT, encode(FLOAT, {"data": value}), round(1e9 * (1.0 + second)))
    topics.write_text("channels:\n  position: {topic: /x, field: data}\n  current: {topic: /i, field: data}\n")
    record = admitted(path, topics)
    assert record.blocks is not None
    assert len(record.recordings) == 3
    assert {one.parts["source"] for one in record.recordings} == {"measured_current"}
    assert read_recording(path, topics).duration == pytest.approx(record.blocks.duration)
