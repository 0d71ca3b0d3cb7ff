"""`eha diagnose` on a recording whose motion is given: the law's own path, and only where nothing drives the plant."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main

TIME = np.arange(4000) / 500.0
SPEED = 0.1 * np.cos(2.0 * np.pi * 0.8 * TIME) + 0.05 * np.cos(2.0 * np.pi * 1.7 * TIME)


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """Position and force of a damper: 80 N of dry and 900 N s/m of viscous friction."""
    force = 80.0 * np.sign(SPEED) + 900.0 * SPEED + np.random.default_rng(1).standard_normal(len(TIME))
    path = tmp_path / "bench.csv"
    table = np.column_stack([TIME, np.cumsum(SPEED) / 500.0, SPEED, force])
    np.savetxt(path, table, delimiter=",", header="time,position,velocity,force", comments="", fmt="%.9g")
    return path


def test_it_writes_the_law_and_says_it(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", str(bench), "--out", str(tmp_path / "out")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "of dry friction opposes motion" in said
    assert "not examined: coil, spool, valve flow" in said
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert found["schema"] == "eha.diagnosis/1"
    assert found["verdict"] == "missing_physics"
    effects = {one["id"]: one["parameters"] for one in found["effects"]}
    assert set(effects) == {"viscous_friction", "coulomb_friction"}
    assert effects["viscous_friction"]["damping"]["value"] == pytest.approx(900.0, rel=0.01)
    assert effects["coulomb_friction"]["force"] == {"value": pytest.approx(80.0, rel=0.02), "std": pytest.approx(
        effects["coulomb_friction"]["force"]["std"]), "unit": "N"}  # fmt: skip
    assert 0.99 < found["explained"]["share"] < 1.0
    assert (tmp_path / "out" / "figures" / "law.png").stat().st_size > 10_000


def test_a_test_recording_is_predicted(bench: Path, tmp_path: Path) -> None:
    table = np.loadtxt(bench, delimiter=",", skiprows=1)
    table[:, 1:] *= -1.0
    other = tmp_path / "other.csv"
    np.savetxt(other, table, delimiter=",", header="time,position,velocity,force", comments="", fmt="%.9g")
    answer = tmp_path / "answer.json"
    assert main(["diagnose", str(bench), "--test", str(other), "--json", str(answer)]) == 0
    errors = json.loads(answer.read_text())["fit"]["held_out"]["force"]
    assert errors["rmse_after"] < 0.05 * errors["rmse_before"]
    assert errors["rmse_after"] < 0.2 * errors["rmse_calibrated"]


def test_a_model_sends_it_the_usual_way(bench: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Held against a plant it can be refused: here for a position in mm, which no stroke has room for."""
    table = np.loadtxt(bench, delimiter=",", skiprows=1)
    table[:, 1] *= 1e3
    table = np.delete(table, 2, axis=1)
    np.savetxt(bench, table, delimiter=",", header="time,position,force", comments="", fmt="%.9g")
    nominal = tmp_path / "nominal.yaml"
    nominal.write_text("eha_sim:\n  ros__parameters: {moving_mass: 2.0, damping_coefficient: 900.0}\n")
    words = ["diagnose", str(bench), "--nominal", str(nominal), "--json", str(tmp_path / "d.json"), "--jobs", "1"]
    assert main(words) == 2
    assert "in mm" in capsys.readouterr().err
    assert main([*words, "--motion-given"]) == 0
    assert "Motion given" in capsys.readouterr().out
