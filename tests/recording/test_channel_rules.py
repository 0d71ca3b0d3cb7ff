"""What a topics file may say of each channel."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest

from eha_core.errors import RecordingError
from eha_core.recording import load_topics_file
from eha_core.recording.channel_rules import ChannelRule
from eha_core.recording.topics_file import TopicsFile


def loaded(folder: Path, text: str) -> TopicsFile:
    path = folder / "topics.yaml"
    path.write_text(text)
    return load_topics_file(path)


def test_every_key_is_taken(tmp_path: Path) -> None:
    found = loaded(
        tmp_path,
        """
namespace: /rig/
channels:
  time: {column: t, unit: ms}
  position: {topic: /x, field: 7, scale: "1e-3", offset: -1}
  pressure_a: {column: p, unit: barg}
  pressure_b: {column: q, unit: bar, reference: absolute}
  supply_pressure: {column: s, unit: barg, reference: absolute}
  pump_speed: {column: 3, unit: rpm}
  force: null
  velocity: {}
""",
    )
    assert found.namespace == "rig"
    assert found.time == ChannelRule(column="t", scale=1e-3, unit="ms")
    assert dict(found.channels) == {
        "position": ChannelRule("/x", "7", None, 1e-3, -1.0),
        "pressure_a": ChannelRule(column="p", scale=1e5, reference="gauge", unit="barg"),
        "pressure_b": ChannelRule(column="q", scale=1e5, reference="absolute", unit="bar"),
        "supply_pressure": ChannelRule(column="s", scale=1e5, reference="absolute", unit="barg"),
        "pump_speed": ChannelRule(column="3", scale=pytest.approx(2 * pi / 60), unit="rpm"),  # type: ignore[arg-type]
        "force": None,
        "velocity": ChannelRule(),
    }
    assert loaded(tmp_path, "channels: {}") == TopicsFile({})
    assert loaded(tmp_path, "channels: {time: null}\nnamespace: ''") == TopicsFile({}, "")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", "needs `channels:` with one entry for each channel"),
        ("channels: {}\nchanels: {}", "unknown key 'chanels'; known are channels, namespace"),
        ("channels: {position: {scale: 0}}", "channel position: scale 0 makes no numbers of what was recorded"),
        ("channels: {position: {scale: .inf}}", "scale inf makes no numbers"),
        ("channels: {position: {offset: .nan}}", "offset nan makes no numbers"),
        ("channels: {position: {offset: [1]}}", r"offset \[1\] is not a number"),
        ("channels: {position: {scale: 2, unit: mm}}", "unit and scale say the same thing; keep one"),
        (
            "channels: {position: {unit: bar}}",
            "channel position: bar is not a unit of it, which is in m; choose m, mm, cm",
        ),
        ("channels: {time: {unit: mm}}", "channel time: mm is not a unit of it, which is in s; choose s, ms, us, ns"),
        ("channels: {position: {unit: parsec}}", "unit 'parsec' is not known"),
        ("channels: {time: 3}", "channel time: needs keys such as"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(RecordingError, match=message) as caught:
        loaded(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_an_offset_of_zero_is_one(tmp_path: Path) -> None:
    assert loaded(tmp_path, "channels: {position: {offset: 0}}").channels["position"] == ChannelRule()
