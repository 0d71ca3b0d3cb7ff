"""`eha steps`: from files to an account, a document and a picture; the plant's planted values; refusals in a line."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest
from stepped import LEVELS, table

from eha_core.cli import main

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("step_tests_example", ROOT / "examples" / "step_tests.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def files(folder: Path, levels: tuple[float, ...] = LEVELS) -> list[str]:
    random = np.random.default_rng(51)
    made = []
    for number, level in enumerate(levels):
        made.append(str(folder / f"run_{number}.csv"))
        pd.DataFrame(table(level, random)).to_csv(made[-1], index=False, float_format="%.5f")
    return made


def test_the_plant_s_planted_values_are_found(
    example: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    example.write(tmp_path / "in")
    assert main(["steps", *map(str, sorted((tmp_path / "in").iterdir())), "--json", "-"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["units"] == {"command": "%", "motion": "mm", "speed": "mm/s", "time": "s"}
    for direction, sign in zip(made["directions"], (1, -1), strict=True):
        assert (direction["sign"], direction["still"], direction["moving"]) == (sign, 8.0, 12.0)
        for name, truth in (("dead_zone", example.DEAD_ZONE), ("gain", sign * example.gain())):
            assert abs(direction[name]["value"] - truth) <= direction[name]["reach"], name
        assert direction["saturation"] is None and direction["delay_slope"] is None
        # coil and spool add some milliseconds to the planted delay
        assert example.DELAY <= direction["delay"]["value"] <= example.DELAY + 0.015
    stop = made["directions"][0]["end_stop"]
    assert abs(stop["value"] - 1e3 * example.STOP) <= stop["reach"] + 0.02  # a stop of steel gives way
    assert made["directions"][1]["end_stop"] is None


def test_an_account_a_document_and_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given, out = files(tmp_path), tmp_path / "out"
    assert main(["steps", *given, "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "positive commands: 8 steps of 8 levels" in told and "deg/s per %" in told
    assert "between 15.0 % (no motion, or below" in told and "no motion" in told
    assert "open: end stop: no step was stopped before its command ended" in told
    assert (out / "steps.png").stat().st_size > 10_000
    made = json.loads((out / "steps.json").read_text())
    assert made["schema"] == "eha.steps/1" and len(made["steps"]) == 8
    assert made["steps"][0]["source"] == "run_0.csv" and "drawn" not in made["steps"][0]


def test_what_is_open_is_told_with_what_to_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["steps", *files(tmp_path, (30.0, 30.0)), "--json", str(tmp_path / "steps.json")]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "open: dead zone and gain: steady speeds of one level only; step to three levels at least" in told
    assert "step to smaller levels until nothing moves" in told and "motion begins at 30.0 % or below" in told


@pytest.mark.parametrize(
    "columns, words, said",
    [
        ({"t": [0.0, 1.0], "duty [%]": [0.0, 1.0], "angle [deg]": [0.0, 1.0]}, [], "has 2 samples"),
        (None, ["--unit", "boom"], "is not COLUMN=UNIT"),
        (None, ["--motion", "elbow"], "has no column 'elbow' for --motion"),
    ],
)
def test_what_cannot_be_used_is_said_in_a_line(
    columns: dict[str, list[float]] | None, words: list[str], said: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    path = tmp_path / "file.csv"
    if columns is None:
        path = Path(files(tmp_path, (30.0,))[0])
    else:
        pd.DataFrame(columns).to_csv(path, index=False)
    assert main(["steps", str(path), *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_file_without_a_step(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(0.0, 3.0, 0.01)
    ramp = {"time": time, "duty [%]": np.clip(20.0 * (time - 1.0), 0.0, None), "angle [deg]": 0.0 * time}
    for command, said in ((ramp["duty [%]"], "step it"), (0.0 * time, "does not step away")):
        pd.DataFrame({**ramp, "duty [%]": command}).to_csv(tmp_path / "file.csv", index=False)
        assert main(["steps", str(tmp_path / "file.csv"), "--json", "-"]) == 2
        error = capsys.readouterr().err
        assert said in error and error.count("\n") == 1
