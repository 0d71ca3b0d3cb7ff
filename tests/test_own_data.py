"""The commands of docs/own_data.md print what stands there."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from eha_core.cli import main

ROOT = Path(__file__).resolve().parent.parent
BLOCKS = re.findall(r"```console\n(.*?)```", (ROOT / "docs" / "own_data.md").read_text(), re.DOTALL)


def commands() -> list[tuple[str, str]]:
    """Each command of the page in turn, and what it prints there."""
    found = []
    for block in BLOCKS:
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, printed = part.partition("\n")
            found.append((command, printed))
    return found


def test_every_command_prints_what_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bags").symlink_to(ROOT / "bags")
    monkeypatch.chdir(tmp_path)
    example = ROOT / "examples" / "log_files.py"
    subprocess.run(
        [sys.executable, example, "bags/rig_coulomb_friction.mcap", "out/logs"], check=True, capture_output=True
    )
    run = 0
    for command, printed in commands():
        program, *words = shlex.split(command)
        if program == "eha" and words[0] == "diagnose":
            continue  # takes a minute; that a diagnosis takes the file is tested with the file's reading
        if program == "eha":
            assert main(words) == 0
            assert capsys.readouterr().out == printed, command
        else:
            output = subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout
            assert output == printed, command
        run += 1
    assert run >= 12


def test_the_topics_file_of_the_page_reads_the_recording_that_the_log_was_made_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import numpy as np

    from eha_core.recording import read_recording

    monkeypatch.chdir(tmp_path)
    bag = ROOT / "bags" / "rig_coulomb_friction.mcap"
    example = ROOT / "examples" / "log_files.py"
    subprocess.run([sys.executable, example, bag, "."], check=True, capture_output=True)
    assert main(["inspect", "rig.csv", "--topics", "rig.yaml"]) == 0
    text = (tmp_path / "rig.yaml").read_text()
    (tmp_path / "rig.yaml").write_text(re.sub(r"# (pressure_.*reference: gauge)", r"\1", text))
    logged, original = read_recording("rig.csv", "rig.yaml"), read_recording(bag).to_dict()
    for name in ("position", "pressure_a", "pressure_b", "voltage_command"):
        np.testing.assert_allclose(logged.channels[name].values, original[name], rtol=1e-8, atol=1e-9)
