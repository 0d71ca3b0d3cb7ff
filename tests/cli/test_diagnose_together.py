"""`eha diagnose A B --test C`: one model for A and B, and how well it predicts C."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from eha_core.cli import main

BAGS = Path(__file__).parents[2] / "bags"


def test_two_recordings_give_one_model_and_a_third_is_only_predicted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = ("rig_coulomb_friction.mcap", "rig_cut_short.mcap")
    nominal = tmp_path / "rig.yaml"
    nominal.write_text(
        "eha_sim:\n  ros__parameters:\n    bulk_modulus: unknown\nper_recording: [supply_pressure]\n", encoding="utf-8"
    )
    third = BAGS / "rig_as_modelled.mcap"
    words = ["--nominal", str(nominal), "--test", str(third), "--json", str(tmp_path / "found.json")]
    # the second of them was cut short, which the status says
    assert main(["diagnose", *(str(BAGS / name) for name in names), *words]) == 3
    printed = capsys.readouterr().out
    assert "Recordings fitted together" in printed
    assert "Test on rig_as_modelled.mcap" in printed
    found = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert [effect["id"] for effect in found["effects"]] == ["coulomb_friction"]
    assert [Path(one["path"]).name for one in found["recordings"]] == list(names)
    for one in found["recordings"]:
        assert one["own_values"]["supply_pressure"] == pytest.approx(21e6, rel=0.02)
        assert one["held_out"]["position"]["rmse_after"] < 1.2 * one["held_out"]["position"]["noise"]
    assert {one["name"] for one in found["parameters"]} >= {"supply_pressure", "supply_pressure@2"}
    (tested,) = found["tests"]
    assert Path(tested["path"]).name == third.name
    # nothing is missing there, so the model with friction predicts it worse than the nominal one
    ahead = {model: each["position"]["ahead"]["0.25"] for model, each in tested["prediction"].items()}
    assert ahead["nominal"] < 0.5 * ahead["augmented"]
