"""`eha curves`: from a bench's tables to an account, files and a rig's nominal file; and what it refuses in a line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from bench import noisy, sweep, table, valve_flow

from eha_core.cli import main
from eha_core.nominal import load_nominal

CURRENT = sweep(21)
CONDITIONS = ["--pressure-drop", "210 bar", "--supply-pressure", "210 bar", "--rated-current", "20 mA"]
FLOW = noisy(valve_flow(CURRENT, ratio=0.1, offset=3e-4, overlap=1e-3, half_width=2e-4), 0.003, 1)


def written(path: Path, columns: dict[str, np.ndarray], separator: str = ",", decimal: str = ".") -> str:
    pd.DataFrame(columns).to_csv(path, index=False, sep=separator, decimal=decimal, float_format="%.6g")
    return str(path)


@pytest.fixture
def flow_file(tmp_path: Path) -> str:
    return written(tmp_path / "flow.csv", dict(table(CURRENT, Q=FLOW)))


def test_from_tables_to_an_account_files_and_a_nominal_file(
    flow_file: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    load = 2e7 * np.tanh((CURRENT + 3e-4) / 3e-3)
    pressure = written(tmp_path / "pressure.csv", dict(table(CURRENT, pA=1e7 + 0.5 * load, pB=1e7 - 0.5 * load)))
    out = tmp_path / "curves"
    assert main(["curves", flow_file, pressure, *CONDITIONS, "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "flow.csv: flow curve, 81 points from -20 to 20 mA" in told and "bar per mA" in told
    assert "overlap, half of the dead zone" in told and "no leakage curve is given" in told
    assert (out / "curves.png").stat().st_size > 10_000
    made = json.loads((out / "curves.json").read_text())
    assert [curve["kind"] for curve in made["curves"]] == ["flow", "pressure gain"]
    gains = {row["name"]: row["value"] for row in made["curves"][1]["values"]}
    assert gains["pressure_gain_share"] == pytest.approx(gains["pressure_gain"] * 20e-3 / 210e5)

    rig = tmp_path / "rig.yaml"
    assert main(["init-rig", "--curves", str(out / "curves.json"), "--rated-current", "20mA", "--out", str(rig)]) == 0
    values = load_nominal(rig).values
    assert values["valve_gain"] == pytest.approx(2e-2 / np.sqrt(1.05e7), rel=0.01)
    assert values["valve_deadband.half_width"] == 0.0 and "# valve_deadband.half_width: 0.00" in rig.read_text()

    # a simulation needs what a diagnosis finds itself
    rig.unlink()
    words = ["init-rig", "--assume", "--curves", str(out / "curves.json"), "--rated-current", "20mA"]
    assert main([*words, "--out", str(rig)]) == 0
    values = load_nominal(rig).values
    assert values["valve_deadband.half_width"] == pytest.approx(1e-3, rel=0.1)
    assert values["valve_null_offset.offset"] == pytest.approx(3e-4, rel=0.2)
    assert "(95 %)" in rig.read_text()


def test_columns_without_units_and_with_foreign_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    german = {"Strom [mA]": 1e3 * CURRENT, "Volumenstrom [l/min]": 6e4 * FLOW}
    plain = {"a": 1e3 * CURRENT, "b": 6e4 * FLOW, "c": 6e4 * FLOW}
    answers = []
    for name, columns, words in (
        ("german", german, []),
        ("plain", plain, ["--current", "a", "--flow", "b", "--unit", "a=mA", "--unit", "b=l/min"]),
    ):
        separator, decimal = (";", ",") if name == "german" else (",", ".")
        path = written(tmp_path / f"{name}.csv", columns, separator, decimal)
        assert main(["curves", path, *words, "--json", "-"]) == 0
        answers.append(json.loads(capsys.readouterr().out)["curves"][0]["values"])
    assert answers[0] == answers[1]


def test_a_command_in_percent_counts_in_amperes_of_full_opening(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "percent.csv", {"command [%]": 5e3 * CURRENT, "Q [l/min]": 6e4 * FLOW})
    for words, full in (([], 20e-3), (["--rated-current", "40mA"], 40e-3)):
        assert main(["curves", path, *words, "--json", str(tmp_path / "c.json")]) == 0
        rows = json.loads((tmp_path / "c.json").read_text())["parameters"]
        overlap = next(row["value"] for row in rows if row["name"] == "valve_deadband.half_width")
        assert overlap == pytest.approx(0.05 * full, rel=0.1)
    rig = ["init-rig", "--curves", str(tmp_path / "c.json"), "--out", str(tmp_path / "rig.yaml")]
    assert main([*rig, "--rated-current", "20mA"]) == 2
    assert "another full command" in capsys.readouterr().err


def test_a_voltage_asks_for_the_rated_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / "volts.csv", {"u [V]": 500.0 * CURRENT, "Q [l/min]": 6e4 * FLOW})
    assert main(["curves", path, "--out", str(tmp_path / "a")]) == 0
    assert "give --rated-voltage" in " ".join(capsys.readouterr().out.split())
    assert (
        main(["curves", path, "--rated-voltage", "10V", "--pressure-drop", "70bar", "--out", str(tmp_path / "a")]) == 0
    )
    assert "valve_gain" in capsys.readouterr().out


@pytest.mark.parametrize(
    "columns, words, said",
    [
        ({"I": CURRENT, "Q [l/min]": FLOW}, [], "column 'I' has no unit; give --unit 'I=mA'"),
        ({"I [mA]": CURRENT, "Q": FLOW}, [], "column 'Q' has no unit; give --unit 'Q=l/min'"),
        ({"I [mA]": CURRENT, "y": FLOW}, [], "no column is a flow or a pressure"),
        ({"x": CURRENT, "Q [l/min]": FLOW}, [], "no column is a current"),
        ({"I [mA]": CURRENT, "QA [l/min]": FLOW, "QB [l/min]": FLOW}, [], "choose one with --flow COLUMN"),
        ({"I [mA]": CURRENT, "Q [l/min]": FLOW}, ["--flow", "q [l/min]"], "has no column 'q [l/min]' for --flow"),
        ({"I [mA]": CURRENT, "Q [l/min]": FLOW}, ["--flow", "I [mA]"], "is in A, not in m^3/s"),
        ({"I [mA]": CURRENT, "Q [l/min]": FLOW}, ["--unit", "Q"], "is not COLUMN=UNIT"),
        ({"I [mA]": CURRENT, "Q [l/min]": FLOW}, ["--unit", "Q [l/min]=furlong"], "furlong is no unit"),
        ({"I [mA]": CURRENT, "Q [l/min]": FLOW}, ["--pressure-drop", "70"], "in which unit?"),
    ],
)
def test_what_cannot_be_used_is_said_in_a_line(
    columns: dict[str, np.ndarray], words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "file.csv", columns)
    assert main(["curves", path, *words, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "text, words, said",
    [
        (None, [], "cannot be read"),
        ("{", [], "is no curves.json"),
        ('{"schema": "eha.budget/1"}', [], "is no curves.json"),
        ("[1]", [], "is no curves.json"),
    ],
)
def test_a_nominal_file_takes_no_other_document(
    text: str | None, words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "curves.json"
    if text is not None:
        path.write_text(text)
    assert main(["init-rig", "--curves", str(path), *words, "--out", str(tmp_path / "rig.yaml")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_a_data_sheet_s_flow_and_a_measured_one_contradict(
    flow_file: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = tmp_path / "curves.json"
    assert main(["curves", flow_file, "--pressure-drop", "70bar", "--json", str(made)]) == 0
    rig = ["init-rig", "--curves", str(made), "--out", str(tmp_path / "rig.yaml")]
    assert main(rig) == 2
    assert "give the full one, as in --rated-current 40mA" in capsys.readouterr().err
    assert main([*rig, "--rated-current", "20mA", "--rated-flow", "40l/min", "--rated-pressure-drop", "70bar"]) == 2
    assert "--rated-flow contradicts the flow gain of --curves" in capsys.readouterr().err
