"""A method that is called once: the folder that it is given, and what becomes of the answers that it writes."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
import yaml

from eha_core.api import known_model
from eha_core.recording import read_recording
from eha_exam.exam_folder import Exam
from eha_exam.files import read_answer
from eha_exam.run_exam import run_exam

ONE_OF_TWO = """
import json, shutil, sys, time
from pathlib import Path
recordings, answers, copy = map(Path, sys.argv[1:])
shutil.copytree(recordings, copy)
while time.process_time() < 1.0: pass
stem = min(recordings.glob("*.mcap")).stem
document = {"schema": "eha.diagnosis/1", "verdict": "parameters", "effects": []}
(answers / f"{stem}.json").write_text(json.dumps(document))
"""


def quiet(stage: str, done: int, of: int) -> None:
    """No progress."""


@pytest.fixture(scope="module")
def exam(tmp_path_factory: pytest.TempPathFactory) -> Exam:
    return Exam(tmp_path_factory.mktemp("exam"), 2, 5, "null_parameters")


def command(folder: Path, source: str, copy: str) -> str:
    script = folder / f"{copy}.py"
    script.write_text(source, encoding="utf-8")
    return f"{{python}} {script} {{recordings}} {{answers}} {folder / copy}"


def test_one_call_gets_all_recordings_and_what_it_leaves_out_has_failed(exam: Exam, tmp_path: Path) -> None:
    methods = {"one": command(tmp_path, ONE_OF_TWO, "copy")}
    marks = run_exam(exam, {}, 1, quiet, methods)["one"]
    assert sorted(mark.outcome for mark in marks) == ["failed", "right"]
    assert marks[0].seconds == marks[1].seconds and 0.5 <= marks[0].seconds < 5.0
    names = {path.name for path in exam.recordings.glob("*.mcap")}
    assert len(names) == 2
    assert {path.name for path in (tmp_path / "copy").glob("*.mcap")} == names
    cases = {case.seed: case for case in (read_answer(exam.sealed(*member).read_text()) for member in exam.members)}
    for path in (tmp_path / "copy").glob("*.yaml"):
        case = cases[int(path.stem.removeprefix("recording-"), 16)]
        assert yaml.safe_load(path.read_text()) == {"eha_sim": {"ros__parameters": dict(case.nominal)}}
        model = known_model(path, read_recording(path.with_suffix(".mcap")))
        assert model.values["moving_mass"] == case.nominal["moving_mass"]
    assert not list(exam.folder.glob("method-*"))
    again = {"one": f"{sys.executable}-none {{recordings}} {{answers}}"}
    assert run_exam(exam, {}, 1, quiet, again)["one"] == marks  # it is not called a second time


def test_a_method_that_breaks_down_has_failed_on_all_that_it_did_not_answer(exam: Exam, tmp_path: Path) -> None:
    source = "import sys; sys.exit('no licence')"
    marks = run_exam(exam, {}, 1, quiet, {"broken": command(tmp_path, source, "broken")})["broken"]
    assert [mark.outcome for mark in marks] == ["failed", "failed"]
    kept = [json.loads(path.read_text()) for path in exam.answers("broken").iterdir()]
    assert [answer["message"].strip() for answer in kept] == ["no licence"] * 2


def test_recordings_of_one_rig_come_with_the_file_that_says_what_differs(tmp_path: Path) -> None:
    exam = Exam(tmp_path / "exam", 1, 2026, "recordings")
    run_exam(exam, {}, 1, quiet, {"one": command(tmp_path, ONE_OF_TWO, "copy")})
    first = exam.names()[0].removesuffix(".mcap")
    there = sorted(path.name for path in (tmp_path / "copy").iterdir())
    assert there == sorted([f"{first}.mcap", f"{first}-2.mcap", f"{first}.yaml"])
    assert yaml.safe_load((tmp_path / "copy" / f"{first}.yaml").read_text())["per_recording"] == ["constant_load.force"]
