"""Running the exam: make recordings, seal the answers, have a tool diagnose every recording, open the answers.

The three steps are apart in time and in folders, and each skips what it finds done, so an interrupted exam goes on.
A tool is a command line; it sees a recording's path and where its diagnosis is to be written, and nothing else.
"""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import count, takewhile
from pathlib import Path
from threading import Event, Timer
from typing import Any

from eha_core.errors import EhaError
from eha_core.workers import Workers
from eha_exam.cases import make_case
from eha_exam.drawing import LOAD
from eha_exam.files import (
    answer_text,
    digest_of,
    further_name,
    read_answer,
    recording_name,
    write_case,
    write_per_recording,
)
from eha_exam.scoring import Answer, Mark, mark
from eha_exam.second import second_recording, with_other_loads
from eha_exam.tiers import plan

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many are finished, and how many there are."""

SECOND = "second"
"""Folder of a tool's answers to two recordings of one rig."""

LONGEST = 600.0
"""s; a tool that takes longer for one recording has failed on it."""

STOPPED = (signal.SIGHUP, signal.SIGINT, signal.SIGTERM)
"""A tool that ends of these has not answered."""

ONE_CORE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Holds a tool's numerical libraries to one core: `--jobs` says how many tools work at once, and times are compared."""


@dataclass(frozen=True)
class Exam:
    """What is run: how many cases, from which seed, of one tier or (None) of all, in which folder; after the `opened`
    first of that seed, whose outcome is known."""

    folder: Path
    cases: int
    seed: int
    tier: str | None = None
    opened: int = 0

    @property
    def members(self) -> list[tuple[str, int]]:
        """(tier, number) of each case."""
        return plan(self.opened + self.cases, self.tier)[self.opened :]


def run_exam(exam: Exam, tools: Mapping[str, str], workers: Workers, progress: Progress) -> dict[str, list[Mark]]:
    """Run the whole exam and return the marks of each tool, by its name."""
    members = exam.members
    _claim(exam)
    _prepare(exam, members, workers, progress)
    for name, command in tools.items():
        _diagnose(exam, name, command, workers, progress)
        _repeat(exam, name, command, workers, progress)
    return {name: open_answers(exam, name) for name in tools}


def _claim(exam: Exam) -> None:
    """Refuse a folder that holds another exam."""
    exam.folder.mkdir(parents=True, exist_ok=True)
    path = exam.folder / "exam.json"
    wanted = {"cases": exam.cases, "seed": exam.seed, "tier": exam.tier, "opened": exam.opened}
    if path.is_file():
        there = json.loads(path.read_text(encoding="utf-8"))
        same = there.get("seed") == exam.seed and there.get("tier") == exam.tier
        if not same:
            raise EhaError(f"{exam.folder}: holds another exam ({there}); give another --out")
    path.write_text(json.dumps(wanted), encoding="utf-8")


def _prepare(exam: Exam, members: Sequence[tuple[str, int]], workers: Workers, progress: Progress) -> None:
    sealed = exam.folder / "sealed"
    missing = [(t, n) for t, n in members if not (sealed / f"{t}-{n:04d}.json").is_file()]
    calls = [(tier, number, exam.seed, str(exam.folder)) for tier, number in missing]
    done = exam.cases - len(calls)
    progress("recordings", done, exam.cases)
    for _ in workers.run(prepare_case, calls):
        done += 1
        progress("recordings", done, exam.cases)
    digests = {}
    for tier, number in members:
        text = (sealed / f"{tier}-{number:04d}.json").read_text(encoding="utf-8")
        digests[recording_name(read_answer(text))] = digest_of(text)
    (exam.folder / "seal.json").write_text(json.dumps(digests, indent=1), encoding="utf-8")


def prepare_case(tier: str, number: int, seed: int, folder: str) -> None:
    """Make one recording and seal its answer; the answer is written last and says that the recording is whole."""
    case, arrays = make_case(tier, number, seed)
    recording = Path(folder) / "recordings" / recording_name(case)
    recording.unlink(missing_ok=True)
    write_case(case, arrays, recording)
    for further, more in enumerate(with_other_loads(case), 2):
        path = recording.with_name(further_name(recording.name, further))
        path.unlink(missing_ok=True)
        write_case(case, more, path)
    if case.loads:
        write_per_recording([f"{LOAD}.force"], case.nominal, recording.with_suffix(".yaml"))
    _write(Path(folder) / "sealed" / f"{tier}-{number:04d}.json", answer_text(case))


def _diagnose(exam: Exam, tool: str, command: str, workers: Workers, progress: Progress) -> None:
    names = json.loads((exam.folder / "seal.json").read_text(encoding="utf-8"))
    answers = exam.folder / "answers" / tool
    missing = [name for name in names if not (answers / f"{Path(name).stem}.json").is_file()]
    calls = [(_recordings_of(exam.folder / "recordings" / name), str(answers), command) for name in missing]
    done = len(names) - len(calls)
    progress(tool, done, len(names))
    for _ in workers.run(diagnose_recording, calls):
        done += 1
        progress(tool, done, len(names))


def _recordings_of(first: Path) -> tuple[str, ...]:
    """A case's recordings: one, or those of a rig that was recorded several times."""
    numbered = (first.with_name(further_name(first.name, number)) for number in count(2))
    return (str(first), *(str(path) for path in takewhile(Path.is_file, numbered)))


def _repeat(exam: Exam, tool: str, command: str, workers: Workers, progress: Progress) -> None:
    """Run the tests that ambiguous diagnoses prescribed, and have both recordings diagnosed together."""
    answers = exam.folder / "answers" / tool
    calls = []
    for tier, number in exam.members:
        sealed = exam.folder / "sealed" / f"{tier}-{number:04d}.json"
        stem = Path(recording_name(read_answer(sealed.read_text(encoding="utf-8")))).stem
        given = json.loads((answers / f"{stem}.json").read_text(encoding="utf-8"))["diagnosis"] or {}
        prescribed = given.get("next_experiment")
        there = (answers / SECOND / f"{stem}.json").is_file()
        if given.get("verdict") == "ambiguous" and prescribed and not there:
            calls.append((str(sealed), str(exam.folder), tool, command, prescribed))
    for done, _ in enumerate(workers.run(repeat_case, calls), 1):
        progress(f"{tool}, second recordings", done, len(calls))


def repeat_case(sealed: str, folder: str, tool: str, command: str, prescribed: Mapping[str, Any]) -> None:
    """Drive the rig of one case with a prescribed test and have a tool diagnose both recordings together.

    A test that the rig cannot run is an answer too: it resolves nothing.
    """
    case = read_answer(Path(sealed).read_text(encoding="utf-8"))
    name = recording_name(case)
    answers = Path(folder) / "answers" / tool / SECOND
    second = answers / name
    second.parent.mkdir(parents=True, exist_ok=True)
    second.unlink(missing_ok=True)
    try:
        write_case(case, second_recording(case, prescribed), second)
    except EhaError as error:
        _write(answers / f"{second.stem}.json", json.dumps(asdict(Answer(None, -1, 0.0, str(error)))))
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
    replaced = {"{recording}": given, "{nominal}": options}
    words: list[str] = []
    for word in shlex.split(command):
        words += replaced.get(word, [word.replace("{python}", sys.executable)])
    answer = run_tool(words)
    _write(Path(answers) / f"{Path(recordings[0]).stem}.json", json.dumps(asdict(answer)))


def run_tool(command: Sequence[str]) -> Answer:
    """Run a tool in an empty folder; the word {answer} becomes the path where it is to write its diagnosis.

    Its seconds are the processor time of the tool and of what it started and waited for: what else runs on the machine,
    or ends meanwhile, is no part of them.
    """
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch) / "diagnosis.json"
        words = [word.replace("{answer}", str(target)) for word in command]
        status, seconds, message = _run(words, scratch)
        diagnosis = json.loads(target.read_text(encoding="utf-8")) if target.is_file() else None
    return Answer(diagnosis, status, seconds, message)


def _run(words: Sequence[str], folder: str) -> tuple[int, float, str]:
    """Exit status, processor time [s] and the end of what was written to stderr."""
    environment = {**os.environ, **ONE_CORE}
    with tempfile.TemporaryFile() as said:
        try:
            process = subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=said)
        except OSError as error:
            raise EhaError(f"{words[0]}: cannot be started ({error.strerror}); check the tool's command") from None
        overdue, seconds = _wait(process)
        said.seek(0)
        message = said.read().decode(errors="replace")[-2000:]
    if overdue:
        return -1, seconds, f"took longer than {LONGEST:g} s"
    if -process.returncode in STOPPED:
        raise EhaError(f"{words[0]}: was stopped from outside; start the exam again, what is done stays done")
    return process.returncode, seconds, message


def _wait(process: subprocess.Popen[bytes]) -> tuple[bool, float]:
    """Whether the process had to be ended for taking too long, and its processor time [s]."""
    overdue = Event()

    def end() -> None:
        overdue.set()
        os.kill(process.pid, signal.SIGKILL)

    limit = Timer(LONGEST, end)
    limit.start()
    try:
        _, ended, used = os.wait4(process.pid, 0)
    except BaseException:
        process.kill()
        raise
    finally:
        limit.cancel()
    process.returncode = os.waitstatus_to_exitcode(ended)
    return overdue.is_set(), used.ru_utime + used.ru_stime


def _write(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_suffix(f".{os.getpid()}")
    draft.write_text(text, encoding="utf-8")
    draft.rename(path)


def open_answers(exam: Exam, tool: str) -> list[Mark]:
    """Open the sealed answers, check the seals and score a tool. EhaError when an answer is not the sealed one."""
    digests = json.loads((exam.folder / "seal.json").read_text(encoding="utf-8"))
    marks = []
    for tier, number in exam.members:
        path = exam.folder / "sealed" / f"{tier}-{number:04d}.json"
        text = path.read_text(encoding="utf-8")
        case = read_answer(text)
        name = recording_name(case)
        if digests.get(name) != digest_of(text):
            raise EhaError(f"{path}: is not the answer that was sealed; make the exam again in another --out")
        answers = exam.folder / "answers" / tool
        stem = Path(name).stem
        second = answers / SECOND / f"{stem}.json"
        marks.append(mark(case, _read(answers / f"{stem}.json"), _read(second) if second.is_file() else None))
    return marks


def _read(path: Path) -> Answer:
    return Answer(**json.loads(path.read_text(encoding="utf-8")))


def report_lost(exam: Exam, lost: Sequence[Mark]) -> dict[str, str]:
    """Write the reports of lost cases; returns each one's page, relative to the exam's folder, by case name."""
    pages = {}
    for case in lost:
        sealed = (exam.folder / "sealed" / f"{case.name}.json").read_text(encoding="utf-8")
        recording = (exam.folder / "recordings" / recording_name(read_answer(sealed))).resolve()
        place = exam.folder / "lost" / case.name
        place.mkdir(parents=True, exist_ok=True)
        words = [sys.executable, "-m", "eha_core.cli", "diagnose", str(recording), "--out", str(place.resolve())]
        _run(words, str(place))
        if (place / "report.html").is_file():
            pages[case.name] = f"lost/{case.name}/report.html"
    return pages
