"""Several runs of one exam are scored as the exam in one run would be."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

from eha_core.cli import main
from eha_exam.errors import ExamError
from eha_exam.scoring import Mark
from eha_exam.shares import summarise
from eha_exam.sittings import read_sittings
from eha_exam.tables import as_json

ABOUT = {"seed": 9, "commit": "abc1234"}


def a_mark(number: int, outcome: str) -> Mark:
    return Mark(
        name=f"single-{number:04d}",
        tier="single",
        noise=3.0,
        concealed=("coulomb_friction",),
        verdict="missing_physics",
        named=("coulomb_friction",) if outcome == "right" else ("constant_load",),
        outcome=outcome,
        site_right=True,
        in_stated_set=None,
        discovery=True,
        intervals=(True, False),
        nominal_intervals=(True,),
        held_out_ratio=1.02,
        curve_r_squared=None,
        seconds=2.0 + number,
        decidable=True,
        seen=("coulomb_friction",),
        false=() if outcome == "right" else ("constant_load",),
        complete=True,
    )


MARKS = [a_mark(0, "right"), a_mark(1, "wrong"), a_mark(2, "right")]


def table(path: Path, marks: Sequence[Mark], about: dict[str, object] | None = None, tool: str = "own") -> Path:
    path.write_text(as_json([summarise(tool, marks)], {tool: marks}, about or ABOUT), encoding="utf-8")
    return path


def test_the_marks_of_two_sittings_are_those_of_one(tmp_path: Path) -> None:
    first, second = table(tmp_path / "a.json", MARKS[:2]), table(tmp_path / "b.json", MARKS[2:])
    marks, shared = read_sittings([first, second])
    assert marks == {"own": MARKS}
    assert shared == ABOUT
    assert summarise("own", marks["own"]) == summarise("own", MARKS)


def test_a_tool_that_sat_one_sitting_alone_is_scored_on_that_one(tmp_path: Path) -> None:
    first, second = table(tmp_path / "a.json", MARKS[:2]), table(tmp_path / "b.json", MARKS[2:], tool="peer")
    marks, _ = read_sittings([first, second])
    assert marks == {"own": MARKS[:2], "peer": MARKS[2:]}


def test_the_verb_writes_the_pooled_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [str(table(tmp_path / "a.json", MARKS[:2])), str(table(tmp_path / "b.json", MARKS[2:]))]
    out = tmp_path / "both"
    assert main(["exam", "--pool", *paths, "--out", str(out), "--require", "0.6"]) == 0
    assert main(["exam", "--pool", *paths, "--out", str(out), "--require", "0.7"]) == 1
    assert "below --require 0.7" in capsys.readouterr().err
    written = json.loads((out / "table.json").read_text(encoding="utf-8"))
    assert (written["about"]["cases"], written["about"]["seed"]) == (3, 9)
    assert "2/3 = 66.7 %" in (out / "table.md").read_text(encoding="utf-8")
    assert (out / "table.html").is_file()


@pytest.mark.parametrize("other", [{"seed": 8, "commit": "abc1234"}, {"seed": 9, "commit": "fff0000"}])
def test_sittings_of_different_exams_are_refused(tmp_path: Path, other: dict[str, object]) -> None:
    paths = [table(tmp_path / "a.json", MARKS[:2]), table(tmp_path / "b.json", MARKS[2:], other)]
    with pytest.raises(ExamError, match="b.json: is of seed .* pool sittings of one exam"):
        read_sittings(paths)


def test_a_case_in_two_sittings_is_refused(tmp_path: Path) -> None:
    paths = [table(tmp_path / "a.json", MARKS[:2]), table(tmp_path / "b.json", MARKS[1:])]
    with pytest.raises(ExamError, match="single-0001 stands in another of these tables too"):
        read_sittings(paths)


@pytest.mark.parametrize("text", [None, "no json", "[]", '{"schema": "eha.diagnosis/1"}'])
def test_what_is_no_table_is_refused(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / "a.json"
    if text is not None:
        path.write_text(text, encoding="utf-8")
    with pytest.raises(ExamError, match="a.json: is not a table.json that eha exam wrote"):
        read_sittings([path])
