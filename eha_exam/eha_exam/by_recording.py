"""A tool: a command that is called once for each case, and again where it has prescribed a test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from eha_exam.errors import ExamError
from eha_exam.exam_folder import Exam, Progress, keep_answer, read_kept, recordings_of
from eha_exam.files import read_answer, recording_name, write_case
from eha_exam.scoring import Answer
from eha_exam.second import second_recording
from eha_exam.tool import run_tool, words_of
from eha_exam.workers import in_parallel

SECOND = "second"
"""Folder of a tool's answers to two recordings of one rig."""


def answer_by_recording(exam: Exam, tool: str, command: str, jobs: int, progress: Progress) -> None:
    """Have a tool diagnose every recording that it has not, and those of the tests that it prescribes; those of a set
    that is made already are not run."""
    _diagnose(exam, tool, command, jobs, progress)
    if exam.source is None:
        _repeat(exam, tool, command, jobs, progress)


def _diagnose(exam: Exam, tool: str, command: str, jobs: int, progress: Progress) -> None:
    missing, total = exam.unanswered(tool), len(exam.names())
    answers = str(exam.answers(tool))
    calls = [(tuple(map(str, recordings_of(exam.recordings / name))), answers, command) for name in missing]
    done = total - len(calls)
    progress(tool, done, total)
    for _ in in_parallel(diagnose_recording, calls, jobs):
        done += 1
        progress(tool, done, total)


def _repeat(exam: Exam, tool: str, command: str, jobs: int, progress: Progress) -> None:
    """Run the tests that ambiguous diagnoses prescribed, and have both recordings diagnosed together."""
    answers = exam.answers(tool)
    calls = []
    for tier, number in exam.members:
        sealed = exam.sealed(tier, number)
        stem = Path(recording_name(read_answer(sealed.read_text(encoding="utf-8")))).stem
        given = read_kept(answers / f"{stem}.json").diagnosis or {}
        prescribed = given.get("next_experiment")
        there = (answers / SECOND / f"{stem}.json").is_file()
        if given.get("verdict") == "ambiguous" and prescribed and not there:
            calls.append((str(sealed), str(exam.folder), tool, command, prescribed))
    for done, _ in enumerate(in_parallel(repeat_case, calls, jobs), 1):
        progress(f"{tool}, second recordings", done, len(calls))


def repeat_case(sealed: str, folder: str, tool: str, command: str, prescribed: Mapping[str, Any]) -> None:
    """Drive the rig of one case with a prescribed test and have a tool diagnose both recordings together.

    A test that the rig cannot run is an answer too: it resolves nothing.
    """
    case = read_answer(Path(sealed).read_text(encoding="utf-8"))
    name = recording_name(case)
    answers = Path(folder) / "answers" / tool / SECOND
    second = answers / name
    second.unlink(missing_ok=True)
    try:
        write_case(case, second_recording(case, prescribed), second)
    except ExamError as error:
        keep_answer(answers, second.stem, Answer(None, -1, 0.0, str(error)))
        return
    diagnose_recording((str(Path(folder) / "recordings" / name), str(second)), str(answers), command)


def diagnose_recording(recordings: Sequence[str], answers: str, command: str) -> None:
    """Have a tool diagnose a recording, or several of one rig, and keep what it said.

    The word {nominal} becomes the options that name the rig's nominal file, where there is one; a tool that has no use
    for it is given the first recording alone then.
    """
    given = [str(Path(recording).resolve()) for recording in recordings]
    nominal = Path(given[0]).with_suffix(".yaml")
    options = ["--nominal", str(nominal)] if nominal.is_file() else []
    if options and "{nominal}" not in command:
        given = given[:1]
    answer = run_tool(words_of(command, {"{recording}": given, "{nominal}": options}))
    keep_answer(Path(answers), Path(recordings[0]).stem, answer)
