"""The other methods on recordings where it is plain what they should and cannot find."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.parameters import NOMINAL
from eha_exam.case import Case
from eha_exam.drawing import draw_case
from eha_exam.files import write_case
from eha_exam.measuring import measure, simulate_case
from eha_exam.peers.__main__ import main
from eha_exam.peers.equations import equations, read_signals
from eha_exam.peers.methods import diagnose


def recording(folder: Path, *effects: tuple[str, dict[str, float | str]]) -> tuple[Case, Path]:
    """A light servo under a multisine for 8 s, good sensors."""
    case = draw_case("single", 14, 2)
    plain = {"duration": 8.0, "rate": 1000.0, "noise": 1.0, "shape": "multisine", "loop": 1.0, "jitter": 0.0}
    perfect = {"position_step": 0.0, "pressure_step": 0.0, "dropout": 0.0, "effects": effects}
    case = replace(case, **{**plain, **perfect})  # type: ignore[arg-type]
    path = folder / "recording.mcap"
    write_case(case, measure(case, simulate_case(case)), path)
    return case, path


def test_the_weak_equations_hold_on_the_truth_and_give_its_parameters_back(tmp_path: Path) -> None:
    case, path = recording(tmp_path)
    force, chamber, _ = equations(read_signals(path))
    mass, damping, _ = np.linalg.lstsq(force.nominal, force.target, rcond=None)[0]
    assert damping == pytest.approx(case.plant["damping_coefficient"], rel=0.05)
    assert mass == pytest.approx(case.plant["moving_mass"], rel=0.3)
    gain = np.linalg.lstsq(chamber.nominal, chamber.target, rcond=None)[0][0]
    assert gain == pytest.approx(case.plant["valve_gain"], rel=0.02)


def test_each_method_says_what_it_can(tmp_path: Path) -> None:
    _, path = recording(tmp_path, ("hardening_spring", {"coefficient": 3e8}))
    assert diagnose("calibration", path)["verdict"] == "parameters"
    for method in ("forward_bic", "localising_regression"):
        assert [effect["id"] for effect in diagnose(method, path)["effects"]] == ["hardening_spring"], method
    pytest.importorskip("pysindy")
    for method in ("sindy_stlsq", "sindy_frols"):
        found = diagnose(method, path)
        assert "hardening_spring" in [effect["id"] for effect in found["effects"]], method
    box = diagnose("black_box", path)
    assert (box["verdict"], box["unknown"]["site"]) == ("unknown_physics", "force")


def test_as_a_command_it_writes_the_answer_or_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case, path = recording(tmp_path)
    answer = tmp_path / "answer.json"
    assert main(["calibration", str(path), str(answer)]) == 0
    assert json.loads(answer.read_text())["schema"] == "eha.diagnosis/1"
    blind = tmp_path / "blind.mcap"
    write_case(
        case, {"voltage_command": (np.arange(9.0), np.zeros(9)), "position": (np.arange(9.0), np.zeros(9))}, blind
    )
    assert main(["calibration", str(blind), str(answer)]) == 2
    assert "has no pressure_a, pressure_b" in capsys.readouterr().err
    assert main(["guess", str(path), str(answer)]) == 2


def test_a_recording_that_knows_no_parameters_is_held_against_the_nominal_ones() -> None:
    path = Path(__file__).parents[2] / "bags" / "rig_coulomb_friction.mcap"
    assert read_signals(path).nominal == {row.name: row.nominal for row in NOMINAL}
    assert "coulomb_friction" in {one["id"] for one in diagnose("sindy_stlsq", path)["effects"]}
