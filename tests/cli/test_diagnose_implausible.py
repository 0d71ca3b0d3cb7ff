"""A recording that cannot be right: one line, the topics file that cures it, and the way to go on all the same."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main
from eha_core.recording import read_recording

MULTISINE = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=3"


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a rig that lacks nothing."""
    path = tmp_path_factory.mktemp("bags") / "rig.mcap"
    words = ["--command", MULTISINE, "--duration", "3", "--noise", "1", "--seed", "11", "--instruments-only"]
    assert main(["simulate", *words, "--out", str(path)]) == 0
    return path


def topics_file(folder: Path, text: str) -> str:
    path = folder / "topics.yaml"
    path.write_text(text)
    return str(path)


@pytest.mark.parametrize(
    ("mapping", "expected"),
    [
        ("channels: {position: {scale: -1}}", "position has the opposite sign"),
        ("channels: {position: {scale: 1000.0}}", "position is in mm"),
        (
            "channels: {pressure_a: {topic: /chamber_b/pressure}, pressure_b: {topic: /chamber_a/pressure}}",
            "pressure_a and pressure_b are swapped",
        ),
    ],
)
def test_one_line_with_a_cure_that_can_be_pasted(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], mapping: str, expected: str
) -> None:
    out = tmp_path / "out"
    assert main(["diagnose", str(recording), "--topics", topics_file(tmp_path, mapping), "--out", str(out)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1 and expected in lines[0] and "--as-recorded" in lines[0]
    assert not out.exists()


def test_the_line_can_be_pasted_as_a_whole_topics_file(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Read backwards, the recording is reported as swapped; read as the cure says, it is read as it was recorded."""
    swapped = "channels: {pressure_a: {topic: /chamber_b/pressure}, pressure_b: {topic: /chamber_a/pressure}}"
    assert main(["diagnose", str(recording), "--topics", topics_file(tmp_path, swapped), "--each"]) == 2
    cure = re.search(r"`(channels: .*)`", capsys.readouterr().err)
    assert cure
    read, sound = read_recording(recording, topics_file(tmp_path, cure[1])), read_recording(recording)
    for name, channel in sound.channels.items():
        assert np.array_equal(read.channels[name].values, channel.values)


def test_as_recorded_diagnoses_and_warns_where_it_is_seen_first(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = topics_file(tmp_path, "channels: {velocity: {scale: -1}}")
    words = ["diagnose", str(recording), "--topics", wrong, "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert "velocity has the opposite sign" in capsys.readouterr().err
    assert main([*words, "--as-recorded"]) == 0
    captured = capsys.readouterr()
    assert "velocity has the opposite sign" in captured.err
    written = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert written["verdict"] == "consistent"
    page = (tmp_path / "out" / "report.html").read_text()
    assert "although velocity has the opposite sign" in page
