"""`eha detect`: from a command to a table, files and JSON; and what it refuses in a line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import eha_core as eha
from eha_core.cli import main

SIGNAL = "multisine:amplitude=0.12,lowest=0.3,highest=8,count=16,period=20,seed=5"
QUICK = ["--duration", "3", "--channels", "position"]


def test_from_a_signal_to_a_table_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["detect", "--command", SIGNAL, *QUICK, "--out", str(tmp_path / "detect")]) == 0
    out = capsys.readouterr().out
    assert "coulomb_friction, force" in out and "with pressures" in out and "detect.png" in out
    made = json.loads((tmp_path / "detect" / "detect.json").read_text())
    assert made["schema"] == "eha.detect/1" and made["test"]["channels"] == ["position"]
    (friction,) = (row for row in made["effects"] if row["id"] == "coulomb_friction")
    assert 0.0 < friction["with_pressures"] < friction["size"]
    found = eha.detect(SIGNAL, duration=3.0, channels=("position",))
    assert next(row.size for row in found.effects if row.effect == "coulomb_friction") == friction["size"]


def test_a_file_of_voltages_and_another_model(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    times = np.arange(1500) / 500.0
    file, model = tmp_path / "command.csv", tmp_path / "rig.yaml"
    rows = np.stack([times, 0.1 * np.sin(2 * np.pi * 2.0 * times)], axis=1)
    np.savetxt(file, rows, delimiter=",", header="time,voltage_command", comments="")
    model.write_text("eha_sim:\n  ros__parameters:\n    moving_mass: 40.0\n")
    assert main(["detect", "--command", str(file), "--nominal", str(model), "--json", "-"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["test"]["duration"] == pytest.approx(3.0, abs=0.01)
    assert next(row["nominal"] for row in made["parameters"] if row["name"] == "moving_mass") == 40.0


@pytest.mark.parametrize(
    "words, told",
    [
        (["--command", "multisin"], "neither a file nor a signal; did you mean multisine"),
        (["--command", SIGNAL, "--channels", "position,spool"], "there is no channel spool"),
        (["--command", SIGNAL, "--rate", "0"], "rate = 0 Hz is out of range"),
        (["--command", SIGNAL, "--noise", "-1"], "noise = -1 is out of range"),
        (["--command", "step:height=0"], "the command is constant"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["detect", *words, "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
