"""`eha inspect`: what it lists, what it takes for certain, what it asks, and that a diagnosis takes its topics file."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from eha_core.cli import main
from eha_core.errors import RecordingError
from eha_core.recording import load_topics_file, read_recording

FOLDER = Path(__file__).resolve().parent.parent / "recording"
BAGS = FOLDER.parent.parent / "bags"
sys.path.append(str(FOLDER))

from example_run import CHANNELS, COUNT, POSITION, TIME, VOLTAGE, written  # noqa: E402
from recordings import SECOND, START, header  # noqa: E402
from test_introspection import EFFORT, introspection_bag  # noqa: E402
from test_introspection import POSITION as STATE  # noqa: E402

ASKED = {
    **dict.fromkeys(("semicolons", "tabs", "dates", "labview", "control_desk", "mat_5", "mat_73", "parquet"), 0),
    "without_names": 4,
}
"""Questions of each kind of table: none, or which column each channel is."""


def inspected(path: Path, topics: Path, capsys: pytest.CaptureFixture[str], status: int = 0) -> str:
    assert main(["inspect", str(path), "--topics", str(topics)]) == status
    return capsys.readouterr().out


def asked(topics: Path) -> dict[str, dict[str, Any]]:
    """The entries of a topics file that still ask."""
    entries = yaml.safe_load(topics.read_text())["channels"]
    return {name: entry for name, entry in entries.items() if isinstance(entry, dict) and "ask" in entry}


def answer(topics: Path, **answers: dict[str, Any] | None) -> None:
    """Give each channel the one of its possible answers that has these values."""
    content = yaml.safe_load(topics.read_text())
    for channel, wanted in answers.items():
        found = [
            one
            for one in content["channels"][channel]["ask"]
            if (one is None) == (wanted is None) and (wanted or {}).items() <= (one or {}).items()
        ]
        assert len(found) == 1, (wanted, content["channels"][channel])
        content["channels"][channel] = found[0]
    topics.write_text(yaml.safe_dump(content))


@pytest.mark.parametrize("kind", list(ASKED))
def test_every_kind_of_table_is_listed_and_read_once_its_questions_are_answered(
    tmp_path: Path, kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path, _ = written(tmp_path, kind)
    topics = tmp_path / "asked.yaml"
    listing = inspected(path, topics, capsys)
    assert len(asked(topics)) == ASKED[kind]
    assert re.search(rf" {COUNT} +1000 ", listing)
    assert f"eha diagnose {path} --topics {topics}" in listing
    if kind == "without_names":
        answer(
            topics, voltage_command={"column": "column 2", "unit": "V"}, position={"column": "column 3", "unit": "mm"}
        )
        answer(
            topics, pressure_a={"column": "column 4", "unit": "bar"}, pressure_b={"column": "column 5", "unit": "bar"}
        )
    channels = read_recording(path, topics).channels
    assert set(channels) == set(CHANNELS)
    for channel, expected in CHANNELS.items():
        np.testing.assert_allclose(
            channels[channel].values, expected, rtol=2e-7, atol=1.0 if "pres" in channel else 1e-9
        )
        np.testing.assert_allclose(channels[channel].time, TIME, atol=5e-7)


def test_a_bag_of_any_topic_names_is_listed_with_what_its_messages_say(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from eha_core.recording import RecordingWriter

    path, topics = tmp_path / "odd.mcap", tmp_path / "topics.yaml"
    joints = "sensor_msgs/msg/JointState"
    with RecordingWriter(path) as writer:
        for k in range(COUNT):
            stamp = START + k * SECOND // 1000
            writer.write_fields("/valve/cmd", "std_msgs/msg/Float64", {"data": VOLTAGE[k]}, stamp)
            two = {"header": header(stamp), "name": ["boom", "arm"], "position": [POSITION[k], 0.5]}
            writer.write_fields("/cyl/joint_states", joints, two, stamp)
            pressure = {"header": header(stamp), "fluid_pressure": 5e6 + k}
            writer.write_fields("/cyl/p_head", "sensor_msgs/msg/FluidPressure", pressure, stamp)
            wrench = {"header": header(stamp), "wrench": {"force": {"x": 100.0 * k}}}
            writer.write_fields("/loadcell", "geometry_msgs/msg/WrenchStamped", wrench, stamp)
    listing = inspected(path, topics, capsys)
    assert re.search(r"/cyl/p_head fluid_pressure +400 +1000 +5e\+06 +5\.0004e\+06 +Pa +pressure_a\n", listing)
    assert set(asked(topics)) == {"position", "voltage_command"}
    answer(topics, position={"field": "position[boom]"}, voltage_command={"unit": "V"})
    certain = load_topics_file(topics).channels
    assert certain["force"] is not None and certain["force"].field == "wrench.force.x"
    channels = read_recording(path, topics).channels
    np.testing.assert_allclose(channels["position"].values, POSITION)
    np.testing.assert_allclose(channels["voltage_command"].values, VOLTAGE)


def test_an_introspection_bag_is_listed_by_its_interfaces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, topics = introspection_bag(tmp_path), tmp_path / "topics.yaml"
    listing = inspected(path, topics, capsys)
    assert f"values[{STATE}]".rpartition("data/")[2] in listing
    answer(topics, voltage_command={"field": f"values[{EFFORT}]", "unit": "V"})
    channels = read_recording(path, topics).channels
    np.testing.assert_allclose(channels["position"].values, np.arange(40) * 1e-6)
    np.testing.assert_allclose(channels["voltage_command"].values, np.arange(40) * 1e-3)


def test_a_bag_of_the_contract_s_names_has_no_questions_and_reads_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = BAGS / "rig_coulomb_friction.mcap", tmp_path / "topics.yaml"
    assert "5 channels certain, 0 questions" in inspected(path, topics, capsys)
    ours, plain = read_recording(path, topics), read_recording(path)
    assert ours.channels.keys() == plain.channels.keys()
    for name, channel in plain.channels.items():
        np.testing.assert_array_equal(ours.channels[name].values, channel.values)


def test_a_damaged_bag_is_listed_as_far_as_it_goes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    listing = inspected(BAGS / "rig_cut_short.mcap", tmp_path / "topics.yaml", capsys, status=3)
    assert "damaged: " in listing and "/joint_states position[piston]" in listing


@pytest.mark.parametrize(
    ("header_line", "row", "asks"),
    [
        ("time,x_mm,stroke_mm", "{t},{k},{k}", "which of these is position?"),
        ("time,x", "{t},{k}", "in which unit is position?"),
        ("time,u", "{t},0.{k}", "voltage_command"),
        ("time,p_a_bar", "{t},1.{k}", "is pressure_a absolute or gauge?"),
        ("t,position", "{k},0.{k}", "in which unit is time?"),
        ("time,signal1", "{t},{k}", "which number is position, if any?"),
        ("time,stuff [bar]", "{t},1{k}", "pressure_a"),
        ("time,f_N,p_a_barg,p_b_barg", "{t},1{k},1{k},2{k}", "in place of both pressures?"),
    ],
)
def test_what_is_ambiguous_is_asked_and_never_an_entry(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], header_line: str, row: str, asks: str
) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    rows = [row.replace("{t}", f"{k * 1e-3:.3f}").replace("{k}", str(k)) for k in range(30)]
    path.write_text("\n".join([header_line, *rows]) + "\n")
    inspected(path, topics, capsys)
    questions = asked(topics)
    (channel,) = [name for name, entry in questions.items() if asks in entry["question"]][:1]
    assert channel not in yaml.safe_load(topics.read_text())["channels"] or "ask" in questions[channel]
    if "time" not in asks:
        assert yaml.safe_load(topics.read_text())["channels"]["time"] == {"column": "time", "unit": "s"}
    with pytest.raises(RecordingError, match=re.escape(f"topics file {topics}: ")):
        load_topics_file(topics)


def test_what_is_asked_for_is_not_taken_for_what_is_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    path.write_text("time,x_mm,x_ref_mm,pA_setpoint_bar\n" + "".join(f"{k / 1000},{k},{k},{k}\n" for k in range(30)))
    inspected(path, topics, capsys)
    assert set(load_topics_file(topics).channels) == {"position"}
    assert not asked(topics)


def test_a_pressure_far_below_zero_is_gauge(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    path.write_text("time,p_a_bar\n" + "".join(f"{k / 1000},{k - 0.5}\n" for k in range(30)))
    inspected(path, topics, capsys)
    rule = load_topics_file(topics).channels["pressure_a"]
    assert rule is not None and rule.reference == "gauge"


def test_a_topics_file_is_never_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    topics = tmp_path / "topics.yaml"
    topics.write_text("mine")
    assert main(["inspect", str(BAGS / "rig_as_modelled.mcap"), "--topics", str(topics)]) == 2
    assert "exists already; choose another name" in capsys.readouterr().err
    assert topics.read_text() == "mine"


def test_names_that_would_write_to_the_terminal_are_shown_and_quoted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    path.write_text('time,"x\x85[mm]","a: {b}"\n' + "".join(f"{k / 1000},{k},{k}\n" for k in range(30)))
    listing = inspected(path, topics, capsys)
    assert "\x85" not in listing
    assert "\x85" not in topics.read_text()
    load_topics_file(topics, assume=True)


def test_a_pump_s_speed_is_found_in_revolutions_a_minute(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, topics = tmp_path / "run.csv", tmp_path / "topics.yaml"
    path.write_text("t_s,n_rpm\n" + "".join(f"{k / 1000},{600 + k}\n" for k in range(30)))
    inspected(path, topics, capsys)
    speed = read_recording(path, topics).channels["pump_speed"]
    np.testing.assert_allclose(speed.values, (600 + np.arange(30)) * 2.0 * np.pi / 60.0)
