"""The court asks what it says, cannot be met by a rig that behaves otherwise, and predicts before it reads answers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from eha_core.cli import main
from eha_core.errors import EhaError
from eha_core.known_answers.real import Question, as_markdown, emps, hold, mr_damper, pneumatic_seal
from eha_core.known_answers.real.sealing import seal
from eha_core.motion_given.law import Law, Value
from eha_core.motion_given.terms import TERMS, Term

TIME = 10.0 * np.arange(3000)


def write_seals(folder: Path, grows: bool) -> Path:
    """Files like the published ones; friction is 2 N (P / 1 bar)^(2/3), or 5 N at any pressure."""
    folder.mkdir(parents=True)
    generator = np.random.default_rng(2)
    phase = 2.0 * np.pi * TIME / 1e3 / 6.0
    displacement = 18.0 * (1.0 - np.cos(phase))
    for name in pneumatic_seal.SEALS:
        for pressure in pneumatic_seal.PRESSURES:
            bar = pressure + 0.005 * generator.standard_normal(len(TIME))
            height = 2.0 * pressure ** (2.0 / 3.0) if grows else 5.0
            rub = -height * np.sign(np.sin(phase)) + 0.05 * generator.standard_normal(len(TIME))
            force = 1e5 * bar * pneumatic_seal.AREA - rub
            volts = np.zeros_like(TIME)
            table = np.column_stack([TIME, volts, volts, volts, displacement, bar, force])
            np.savetxt(folder / f"{name}_{pressure}bar.csv", table, fmt="%.6f")
    return folder


@pytest.mark.parametrize("grows", [True, False])
def test_friction_that_grows_with_pressure_is_told_from_friction_that_does_not(tmp_path: Path, grows: bool) -> None:
    questions = pneumatic_seal.ask(write_seals(tmp_path / "seals", grows), tmp_path / "out")
    laws, predictions = questions[:2], questions[2:]
    assert [one.met for one in laws] == [grows, grows]
    assert len(predictions) == 8
    assert all(one.met and one.seal for one in predictions)
    listed = (tmp_path / "out" / "sealed.txt").read_text().splitlines()
    assert [line[:8] for line in listed] == [one.seal for one in predictions]


def test_the_axis_files_are_found_from_the_folder_that_a_diagnosis_is_run_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here" / "out").mkdir(parents=True)
    (tmp_path / "here" / "out" / f"{emps.FOUND_ON}.csv").write_text("time,force,position\n")

    def diagnose(words: list[str]) -> tuple[dict[str, str], float]:
        monkeypatch.chdir(tmp_path)
        assert all(Path(word).is_file() for word in words if not word.startswith("--"))
        return {"verdict": "asked"}, 0.0

    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setattr(emps, "diagnose", diagnose)
    assert emps._diagnose(Path("out"), emps.VISCOUS_ONLY) == {"verdict": "asked"}


def test_a_prediction_that_was_changed_is_not_opened(tmp_path: Path) -> None:
    sealed = seal(tmp_path, "force", np.arange(3.0))
    np.testing.assert_array_equal(sealed.open(), np.arange(3.0))
    np.save(sealed.path, np.zeros(3))
    with pytest.raises(EhaError, match="changed after it was sealed"):
        sealed.open()


@pytest.mark.parametrize(("heights", "met"), [((100, 300, 500, 700, 900), True), ((100, 300, 290, 700, 900), False)])
def test_dry_friction_has_to_grow_with_each_step_of_the_current(heights: tuple[int, ...], met: bool) -> None:
    laws = {
        current: Law((), (), (), 0.0, 0.0, {mr_damper.HYSTERETIC: {"force": Value(float(height), 5.0, "N")}})
        for current, height in zip(mr_damper.CURRENTS, heights, strict=True)
    }
    named = {current: replace(law, terms=fit_terms()) for current, law in laws.items()}
    assert mr_damper._growth(named).met == met
    assert not mr_damper._growth({**named, "0A": laws["0A"]}).met


def fit_terms() -> tuple[Term, ...]:
    return tuple(term for term in TERMS if term.id == mr_damper.HYSTERETIC)


def test_absent_rigs_are_skipped_in_a_line_each(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines: list[str] = []
    assert hold(tmp_path, tmp_path / "out", lines.append) == []
    assert len(lines) == 3
    assert all(line.startswith("skipped: ") for line in lines)
    assert main(["exam", "--real", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    assert capsys.readouterr().err.count("skipped: ") == 3


def test_an_incomplete_folder_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mr_damper").mkdir()
    assert main(["exam", "--real", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "10mm1Hz0A.txt: is not there" in capsys.readouterr().err


def test_the_table_says_what_is_met() -> None:
    table = as_markdown([Question("rig", "a", "b", "c", True, "12345678"), Question("rig", "d", "e", "f", False)])
    assert "| rig | a | b | c (sealed 12345678) | yes |" in table
    assert table.endswith("1 of 2 questions are met.\n")
