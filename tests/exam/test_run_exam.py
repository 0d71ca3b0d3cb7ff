"""The exam as a whole with tools whose answers are known: it prepares, seals, resumes, scores and tabulates."""

from __future__ import annotations

import gc
import json
import os
import subprocess
import sys

import pytest

from eha_core.recording import read_recording
from eha_exam.errors import ExamError
from eha_exam.exam_folder import Exam
from eha_exam.files import read_answer
from eha_exam.page import as_html
from eha_exam.run_exam import open_answers, run_exam
from eha_exam.shares import summarise
from eha_exam.tables import as_json, as_markdown
from eha_exam.tool import run_tool

SILENT = """
import json, sys
json.dump({"schema": "eha.diagnosis/1", "verdict": "parameters", "effects": [], "location": []}, open(sys.argv[2], "w"))
"""
LOUD = """
import json, sys
effect = {"id": "coulomb_friction", "site": "force", "parameters": {}}
json.dump({"schema": "eha.diagnosis/1", "verdict": "missing_physics", "effects": [effect]}, open(sys.argv[2], "w"))
"""
UNSURE = """
import json, sys
reference = {"mode": "voltage", "signal": "sine", "sine.amplitude": 0.02, "sine.frequency": 1.0}
first = {"verdict": "ambiguous", "effects": [], "next_experiment": {"reference": reference}}
both = {"verdict": "parameters", "effects": []}
json.dump(both if len(sys.argv) == 4 else first, open(sys.argv[-1], "w"))
"""
BROKEN = "import sys; sys.exit('no licence')"


def quiet(stage: str, done: int, of: int) -> None:
    """No progress."""


@pytest.fixture(scope="module")
def exam(tmp_path_factory: pytest.TempPathFactory) -> Exam:
    return Exam(tmp_path_factory.mktemp("exam"), 2, 5, "null_parameters")


@pytest.fixture(scope="module")
def tools(exam: Exam) -> dict[str, str]:
    commands = {}
    for name, source in (("silent", SILENT), ("loud", LOUD), ("unsure", UNSURE), ("broken", BROKEN)):
        script = exam.folder / f"{name}.py"
        script.write_text(source, encoding="utf-8")
        commands[name] = f"{{python}} {script} {{recording}} {{answer}}"
    return commands


def test_known_answers_get_the_marks_they_deserve(exam: Exam, tools: dict[str, str]) -> None:
    scored = {name: tools[name] for name in ("silent", "loud", "broken")}
    marks = run_exam(exam, scored, 1, quiet)
    assert [m.outcome for m in marks["silent"]] == ["right", "right"]
    assert [(m.outcome, m.discovery) for m in marks["loud"]] == [("wrong", True)] * 2
    assert [m.outcome for m in marks["broken"]] == ["failed", "failed"]
    summaries = [summarise(name, marks[name]) for name in scored]
    false = next(t for t in summaries[1].targets if "false discoveries" in t.statement)
    assert false.met is False
    table = as_markdown(summaries, {"seed": 5})
    assert "| null_parameters | silent | 2 | 2/2 = 100.0 % (34.2 to 100.0) |" in table
    assert json.loads(as_json(summaries, marks, {}))["tools"]["loud"]["marks"][0]["named"] == ["coulomb_friction"]
    page = as_html(summaries, marks, {}, {marks["silent"][0].name: "lost/page.html"})
    assert page.count('href="lost/page.html"') == 1  # reports are of the first tool's diagnoses


def test_recordings_say_nothing_of_what_is_concealed(exam: Exam, tools: dict[str, str]) -> None:
    run_exam(exam, {"silent": tools["silent"]}, 1, quiet)
    names = sorted(path.name for path in (exam.folder / "recordings").iterdir())
    assert all("null" not in name for name in names)
    answers = [read_answer(path.read_text()) for path in sorted((exam.folder / "sealed").iterdir())]
    for case in answers:
        recording = read_recording(exam.folder / "recordings" / f"recording-{case.seed:012x}.mcap")
        assert dict(recording.parameters) == pytest.approx(dict(case.nominal))
        assert recording.duration == pytest.approx(case.duration)
        assert any(
            abs(case.nominal[name] / case.plant[name] - 1.0) > 0.02
            for name in case.plant
            if case.plant[name] and name in case.nominal
        )


def test_an_interrupted_exam_goes_on_where_it_stopped(exam: Exam, tools: dict[str, str]) -> None:
    only = {"silent": tools["silent"]}
    run_exam(exam, only, 1, quiet)
    kept, lost = sorted((exam.folder / "answers" / "silent").iterdir())
    before = kept.stat().st_mtime_ns
    lost.unlink()
    stages = []
    run_exam(exam, only, 1, lambda stage, done, of: stages.append((stage, done, of)))
    assert stages == [("recordings", 2, 2), ("silent", 1, 2), ("silent", 2, 2)]
    assert kept.stat().st_mtime_ns == before


def test_a_prescribed_test_is_run_and_both_recordings_are_diagnosed(exam: Exam, tools: dict[str, str]) -> None:
    marks = run_exam(exam, {"unsure": tools["unsure"]}, 1, quiet)["unsure"]
    assert [(m.outcome, m.resolved) for m in marks] == [("abstained", True)] * 2
    second = sorted((exam.folder / "answers" / "unsure" / "second").glob("*.mcap"))
    assert [read_recording(path).duration for path in second] == [10.0, 10.0]


def test_an_answer_that_was_changed_is_refused(exam: Exam, tools: dict[str, str]) -> None:
    run_exam(exam, {"silent": tools["silent"]}, 1, quiet)
    path = next(iter(sorted((exam.folder / "sealed").iterdir())))
    sealed = path.read_text()
    path.write_text(sealed.replace("null_parameters", "null"))
    with pytest.raises(ExamError, match="not the answer that was sealed"):
        open_answers(exam, "silent")
    path.write_text(sealed)


def test_a_folder_with_another_exam_is_refused(exam: Exam, tools: dict[str, str]) -> None:
    run_exam(exam, {"silent": tools["silent"]}, 1, quiet)
    with pytest.raises(ExamError, match="another exam"):
        run_exam(Exam(exam.folder, 2, 6, exam.tier), tools, 1, quiet)


def test_a_tool_that_does_not_exist_is_said_in_one_line(exam: Exam) -> None:
    with pytest.raises(ExamError, match="cannot be started"):
        run_exam(exam, {"ghost": f"{sys.executable}-none {{recording}} {{answer}}"}, 1, quiet)


def test_a_tool_is_held_to_one_core() -> None:
    source = "import json, os, sys; json.dump({'verdict': os.environ['OMP_NUM_THREADS']}, open(sys.argv[1], 'w'))"
    assert run_tool([sys.executable, "-c", source, "{answer}"]).diagnosis == {"verdict": "1"}


def test_a_tool_is_charged_for_the_processor_and_not_for_waiting() -> None:
    waits = "import time; time.sleep(3.0)"
    works = "import time\nwhile time.process_time() < 1.0: pass"
    assert run_tool([sys.executable, "-c", waits]).seconds < 1.0 < run_tool([sys.executable, "-c", works]).seconds


def test_a_tool_is_charged_for_what_it_starts_and_not_for_what_ends_meanwhile() -> None:
    works = "import time\nwhile time.process_time() < 2.0: pass"
    starts = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {works!r}])"
    assert run_tool([sys.executable, "-c", starts]).seconds > 2.0
    forgotten = subprocess.Popen([sys.executable, "-c", works])
    number = forgotten.pid
    with pytest.warns(ResourceWarning, match="is still running"):
        del forgotten
        gc.collect()
    os.waitid(os.P_PID, number, os.WEXITED | os.WNOWAIT)
    assert run_tool([sys.executable, "-c", "pass"]).seconds < 1.0


def test_a_tool_that_takes_too_long_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eha_exam.tool.LONGEST", 1.0)
    answer = run_tool([sys.executable, "-c", "import time; time.sleep(600.0)"])
    assert (answer.status, answer.message) == (-1, "took longer than 1 s")


@pytest.mark.parametrize("sent", ["SIGTERM", "SIGINT", "SIGHUP"])
def test_a_tool_that_was_stopped_from_outside_has_not_answered(sent: str) -> None:
    source = f"import os, signal; signal.signal(signal.{sent}, signal.SIG_DFL); os.kill(os.getpid(), signal.{sent})"
    with pytest.raises(ExamError, match="was stopped from outside; start the exam again"):
        run_tool([sys.executable, "-c", source])


def test_a_tool_that_breaks_down_has_failed() -> None:
    answer = run_tool([sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"])
    assert (answer.diagnosis, answer.status) == (None, -9)


def test_cases_whose_outcome_is_known_are_left_out(exam: Exam) -> None:
    whole = Exam(exam.folder, 5, exam.seed).members
    assert Exam(exam.folder, 3, exam.seed, opened=2).members == whole[2:]
