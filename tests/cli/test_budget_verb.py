"""`eha budget`: from a diagnosis or from values, to a table, files and JSON; and what it refuses in a line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import eha_core as eha
from eha_core.cli import main
from eha_core.paper import as_json, reproduce

ROOT = Path(__file__).resolve().parents[2]
SINE = "sine:amplitude=0.01,frequency=2"
QUICK = ["--reference", SINE, "--duration", "0.5", "--skip", "0.1"]


def diagnosis(folder: Path) -> Path:
    """A diagnosis.json that `eha diagnose` wrote, of a rig with 300 N of friction."""
    recording = eha.simulate("multisine:amplitude=0.1", 3.0, {"coulomb_friction.force": 300.0}, noise=1.0, rate=500.0)
    path = folder / "diagnosis.json"
    from eha_core.report.document import as_json as told

    path.write_text(told(eha.diagnose(recording, {}).diagnosis))
    return path


def test_from_a_diagnosis_to_a_table_and_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = diagnosis(tmp_path)
    assert main(["budget", str(found), *QUICK, "--out", str(tmp_path / "budget")]) == 0
    out = capsys.readouterr().out
    assert "coulomb friction" in out and "1. coulomb friction" in out and "budget.png" in out
    made = json.loads((tmp_path / "budget" / "budget.json").read_text())
    assert made["today"]["value"] > made["modelled"]["value"] > 0.0 and made["today"]["reach"] > 0.0
    total = made["modelled"]["value"] + sum(row["share"]["value"] for row in made["shares"])
    assert abs(total - made["today"]["value"]) < 1e-9 * total
    in_python = eha.budget(found, SINE, duration=0.5, skip=0.1)
    assert in_python.today.value == made["today"]["value"]


def test_the_paper_s_level_costs_what_the_paper_s_table_has(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--set", "internal_leakage=1e-10", "--nominal", str(ROOT / "examples" / "leakage_free.yaml")]
    words += ["--command", "sine:amplitude=8.4e-3,frequency=1", "--rate", "1000", "--json", "-"]
    assert main(["budget", *words]) == 0
    made = json.loads(capsys.readouterr().out)
    level = as_json(reproduce().levels)["levels"][2]
    assert level["internal_leakage"] == 1e-10
    assert made["today"]["value"] == made["shares"][0]["share"]["value"] == pytest.approx(level["rmse"], rel=1e-12)
    assert made["modelled"]["value"] == 0.0


@pytest.mark.parametrize(
    "words, told",
    [
        (["--set", "coulomb_friction.force=1"], "give --reference SIGNAL"),
        (["--reference", SINE], "give a diagnosis.json or a recording"),
        (["missing.json", "--reference", SINE], "missing.json: there is no such file"),
        (["--set", "coulomb_friction.force", "--reference", SINE], "is not NAME=VALUE"),
        (["--set", "moving_mass=12", "--reference", SINE], "there is nothing to repair"),
        (["--set", "coulomb_friction.force=1", "--reference", "sin"], "there is no signal 'sin'; did you mean sine"),
        (["--set", "coulomb_friction.force=1", "--reference", SINE, "--controller", "lqt"], "did you mean lqr"),
    ],
)
def test_what_cannot_be_done_is_one_line(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["budget", *words]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1


def test_a_file_that_is_no_diagnosis_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "other.json"
    for text, told in (("{", "no JSON"), ("[]", "no diagnosis"), ('{"schema": "eha.budget/1"}', "no diagnosis")):
        path.write_text(text)
        assert main(["budget", str(path), "--reference", SINE]) == 2
        error = capsys.readouterr().err
        assert str(path) in error and told in error
