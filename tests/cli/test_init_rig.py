"""`eha init-rig`: the file that options or answers make is one that a diagnosis takes as its nominal model."""

from __future__ import annotations

import io
from math import pi
from pathlib import Path

import pytest

from eha_core.cli import main
from eha_core.nominal import load_nominal
from eha_core.parameters import catalogue, load_parameters
from eha_core.plant import PAPER
from eha_core.plant.parts import parts
from eha_core.rig import asked_of

OPTIONS = ["--bore", "40mm", "--rod", "25 mm", "--rated-flow", "40l/min", "--rated-pressure-drop", "70 bar"]


def test_options_make_a_nominal_file_with_units_and_origins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), *OPTIONS]) == 0
    assert path.read_text() in capsys.readouterr().out
    model = load_nominal(path)
    assert model.values["piston_area"] == pytest.approx(pi * 0.02**2, rel=1e-5)
    assert {"bulk_modulus", "moving_mass", "supply_pressure"} <= model.unknown
    assert not {"piston_area", "valve_gain", "external_leakage"} & model.unknown
    lines = [line.strip() for line in path.read_text().splitlines() if line.startswith("    ")]
    for comment, entry in zip(lines[::2], lines[1::2], strict=True):
        row = catalogue()[entry.partition(":")[0]]
        assert comment.startswith(f"# {row.meaning} [{row.unit}]: ")


def test_assumed_values_make_a_file_that_a_simulation_takes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), "--assume", *OPTIONS]) == 0
    assert load_parameters(path)["bulk_modulus"] == catalogue()["bulk_modulus"].nominal
    assert "0 unknown" in capsys.readouterr().out
    assert path.read_text().count("assumed: the catalogue's") >= 5


def test_answers_make_the_same_file_as_options(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    by_options, by_answers = tmp_path / "options.yaml", tmp_path / "answers.yaml"
    assert main(["init-rig", "--out", str(by_options), *OPTIONS]) == 0
    known = dict(zip(OPTIONS[::2], OPTIONS[1::2], strict=True))
    answers = [known.get(f"--{datum.name.replace('_', '-')}", "") for datum in asked_of(PAPER)]
    bore = next(k for k, datum in enumerate(asked_of(PAPER)) if datum.name == "bore")
    answers[bore:bore] = ["40", "forty"]  # asked again until it is a value
    monkeypatch.setattr("sys.stdin", io.StringIO("\n".join(answers) + "\n"))
    assert main(["init-rig", "--out", str(by_answers), "--ask"]) == 0
    assert by_answers.read_text() == by_options.read_text()
    printed = capsys.readouterr().err
    assert printed.count("diameter of the piston [40 mm]") == 3
    assert "in which unit" in printed and "is not a number with a unit" in printed


def test_answers_that_end_leave_the_rest_unknown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("\n\n10 V\n"))
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), "--ask"]) == 0
    assert load_nominal(path).values["coil_resistance"] == pytest.approx(500.0)
    assert "moving_mass" in load_nominal(path).unknown


def test_a_wrong_value_and_a_file_that_is_there_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), "--bore", "40"]) == 2
    assert capsys.readouterr().err == "eha init-rig: --bore 40: in which unit? write for example '40 mm'\n"
    assert not path.exists()
    path.write_text("mine")
    assert main(["init-rig", "--out", str(path), *OPTIONS]) == 2
    assert "exists already; choose another name" in capsys.readouterr().err
    assert path.read_text() == "mine"


@pytest.mark.parametrize("source", sorted(parts("source")))
def test_every_source_has_its_file(tmp_path: Path, source: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), "--source", source, "--moving-mass", "24 kg"]) == 0
    model = load_nominal(path)
    assert model.composition.source.id == source
    assert model.values["moving_mass"] == 24.0
    entries = [line.strip().partition(":")[0] for line in path.read_text().splitlines() if line.startswith("    ")]
    assert ("valve_gain" in entries) == ("valve_gain" in model.composition.rows)
    assert ("coil_resistance" in entries) == (source == "servo_valve")
    assert f"Go on with: eha diagnose RECORDING --nominal {path}" in capsys.readouterr().out


def test_a_pump_s_displacement_is_by_radian(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    pump = ["--source", "switched_pump", "--pump-displacement", "10 cm^3", "--supply-pressure", "180 bar"]
    assert main(["init-rig", "--out", str(path), *pump]) == 0
    values = load_nominal(path).values
    assert values["pump_displacement"] == pytest.approx(1e-5 / (2.0 * pi), rel=1e-5)
    assert values["supply_pressure"] == 180e5  # where its relief valve opens


def test_a_line_that_tells_nothing_of_a_source_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rig.yaml"
    assert main(["init-rig", "--out", str(path), "--source", "measured_flow", "--rated-flow", "40 l/min"]) == 2
    assert "--rated-flow does not apply to a rig on measured_flow; leave it out" in capsys.readouterr().err
    assert not path.exists()
