"""What `eha diagnose` leaves in its folder."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from eha_core.diagnosis.result import Diagnosis
from eha_core.errors import EhaError
from eha_core.parameters import load_parameters
from eha_core.recording import load_topics_file, read_recording
from eha_core.report.comparison import write_comparison
from eha_core.report.files import write_report


def test_a_folder_holds_everything_and_a_second_run_replaces_it(friction: Diagnosis, tmp_path: Path) -> None:
    first = write_report(friction, tmp_path / "out")
    assert write_report(friction, tmp_path / "out") == first
    assert [path.name for path in first] == [
        "report.html",
        "figures",
        "diagnosis.json",
        "fitted.yaml",
        "comparison.mcap",
    ]
    assert all(path.exists() for path in first)
    assert load_parameters(tmp_path / "out" / "fitted.yaml") == dict(friction.fitted_values)


def test_a_folder_that_is_a_file_is_named(friction: Diagnosis, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(EhaError, match="out: cannot be written"):
        write_report(friction, tmp_path / "out")


def test_results_and_the_document_wait_for_no_plotting() -> None:
    code = (
        "import sys, eha_core.report.files, eha_core.report.results\nprint({'matplotlib', 'plotly'} & set(sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "set()\n"


@pytest.fixture
def comparison(friction: Diagnosis, tmp_path: Path) -> Path:
    path = tmp_path / "comparison.mcap"
    write_comparison(friction, path)
    return path


def test_an_independent_reader_finds_the_three_sources(comparison: Path, friction: Diagnosis) -> None:
    with AnyReader([comparison]) as reader:
        topics = {one.topic: one for one in reader.connections}
        for source in ("measured", "nominal", "augmented"):
            for topic in ("joint_states", "chamber_a/pressure", "chamber_b/pressure"):
                assert topics[f"/{source}/{topic}"].msgcount == len(friction.pictures.time["position"])
        messages = list(reader.messages([topics["/augmented/joint_states"]]))
        motion = [reader.deserialize(raw, "sensor_msgs/msg/JointState") for _, _, raw in messages]
    assert [one.position[0] for one in motion] == friction.pictures.after["position"].tolist()
    assert motion[0].name == ["piston"]
    stamps = np.array([stamp for _, stamp, _ in messages]) - friction.start_stamp
    assert np.allclose(1e-9 * stamps, friction.pictures.time["position"], atol=2e-9)
    assert motion[5].header.stamp.sec * 1_000_000_000 + motion[5].header.stamp.nanosec == messages[5][1]


def test_its_measured_part_reads_back_as_the_recording_it_came_from(
    comparison: Path, friction: Diagnosis, tmp_path: Path
) -> None:
    topics = tmp_path / "topics.yaml"
    topics.write_text(
        "channels:\n"
        "  voltage_command: {topic: /measured/voltage_command, field: data}\n"
        "  position: {topic: /measured/joint_states, field: 'position[0]'}\n"
        "  pressure_a: {topic: /measured/chamber_a/pressure, field: fluid_pressure, reference: absolute}\n"
    )
    channels = read_recording(comparison, load_topics_file(topics)).channels
    for name in ("position", "pressure_a", "voltage_command"):
        assert np.allclose(channels[name].values, friction.pictures.measured[name], rtol=1e-9)
