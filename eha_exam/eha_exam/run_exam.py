"""Running the exam: make recordings, seal the answers, have every tool and method diagnose, open the answers.

The steps are apart in time and in folders, and each skips what it finds done, so an interrupted exam goes on. A tool
sees a recording's path and where its diagnosis is to be written, and nothing else.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from eha_exam.by_folder import answer_by_folder
from eha_exam.by_recording import SECOND, answer_by_recording
from eha_exam.cases import make_case
from eha_exam.drawing import LOAD
from eha_exam.errors import ExamError
from eha_exam.exam_folder import Exam, Progress, read_kept, write_whole
from eha_exam.files import (
    answer_text,
    digest_of,
    further_name,
    read_answer,
    recording_name,
    write_case,
    write_nominal,
)
from eha_exam.scoring import Mark, mark
from eha_exam.sealed_set import open_set, take_set
from eha_exam.second import with_other_loads
from eha_exam.tool import run_command, words_of
from eha_exam.workers import in_parallel


def run_exam(
    exam: Exam,
    tools: Mapping[str, str],
    jobs: int,
    progress: Progress,
    methods: Mapping[str, str] | None = None,
) -> dict[str, list[Mark]]:
    """Run the whole exam and return the marks of each tool, then of each method, by its name.

    Args:
        exam: what is run.
        tools: commands that are called for each recording, by name.
        jobs: processes that make recordings and run tools.
        progress: is told what is done.
        methods: commands that are called once for all recordings, by name.
    """
    _claim(exam)
    if exam.source is None:
        _prepare(exam, exam.members, jobs, progress)
    else:
        take_set(exam.source, exam)
    for name, command in tools.items():
        answer_by_recording(exam, name, command, jobs, progress)
    for name, command in (methods or {}).items():
        answer_by_folder(exam, name, command, progress)
    if exam.source is not None:
        open_set(exam.source, exam)
    return {name: open_answers(exam, name) for name in (*tools, *(methods or {}))}


def _claim(exam: Exam) -> None:
    """Refuse a folder that holds another exam."""
    exam.folder.mkdir(parents=True, exist_ok=True)
    path = exam.folder / "exam.json"
    wanted = {"cases": exam.cases, "seed": exam.seed, "tier": exam.tier, "opened": exam.opened}
    wanted["set"] = exam.source is not None
    if path.is_file():
        there = json.loads(path.read_text(encoding="utf-8"))
        if any(there.get(name, False) != wanted[name] for name in ("seed", "tier", "set")):
            raise ExamError(f"{exam.folder}: holds another exam ({there}); give another --out")
    path.write_text(json.dumps(wanted), encoding="utf-8")


def _prepare(exam: Exam, members: Sequence[tuple[str, int]], jobs: int, progress: Progress) -> None:
    missing = [(tier, number) for tier, number in members if not exam.sealed(tier, number).is_file()]
    calls = [(tier, number, exam.seed, str(exam.folder)) for tier, number in missing]
    done = exam.cases - len(calls)
    progress("recordings", done, exam.cases)
    for _ in in_parallel(prepare_case, calls, jobs):
        done += 1
        progress("recordings", done, exam.cases)
    digests = {}
    for tier, number in members:
        text = exam.sealed(tier, number).read_text(encoding="utf-8")
        digests[recording_name(read_answer(text))] = digest_of(text)
    (exam.folder / "seal.json").write_text(json.dumps(digests, indent=1), encoding="utf-8")


def prepare_case(tier: str, number: int, seed: int, folder: str, compressed: bool = True) -> None:
    """Make one recording and seal its answer; the answer is written last and says that the recording is whole."""
    case, arrays = make_case(tier, number, seed)
    recording = Path(folder) / "recordings" / recording_name(case)
    recording.unlink(missing_ok=True)
    write_case(case, arrays, recording, compressed)
    for further, more in enumerate(with_other_loads(case), 2):
        path = recording.with_name(further_name(recording.name, further))
        path.unlink(missing_ok=True)
        write_case(case, more, path, compressed)
    if case.loads:
        write_nominal(case.nominal, recording.with_suffix(".yaml"), [f"{LOAD}.force"])
    write_whole(Path(folder) / "sealed" / f"{tier}-{number:04d}.json", answer_text(case))


def open_answers(exam: Exam, tool: str) -> list[Mark]:
    """Open the sealed answers, check the seals and score a tool. ExamError when an answer is not the sealed one."""
    digests = json.loads((exam.folder / "seal.json").read_text(encoding="utf-8"))
    answers = exam.answers(tool)
    marks = []
    for path in exam.sealed_files():
        text = path.read_text(encoding="utf-8")
        case = read_answer(text)
        name = recording_name(case)
        if digests.get(name) != digest_of(text):
            raise ExamError(f"{path}: is not the answer that was sealed; make the exam again in another --out")
        stem = Path(name).stem
        second = answers / SECOND / f"{stem}.json"
        marks.append(mark(case, read_kept(answers / f"{stem}.json"), read_kept(second) if second.is_file() else None))
    return marks if exam.source is None else [replace(one, resolved=None) for one in marks]


def report_lost(exam: Exam, lost: Sequence[Mark], command: str) -> dict[str, str]:
    """Have reports of lost cases written; returns each one's page, relative to the exam's folder, by case name.

    The words {recording} and {folder} of the command become the recording and a folder, in which it is to write
    report.html.
    """
    pages = {}
    for case in lost:
        sealed = (exam.folder / "sealed" / f"{case.name}.json").read_text(encoding="utf-8")
        recording = (exam.recordings / recording_name(read_answer(sealed))).resolve()
        place = exam.folder / "lost" / case.name
        place.mkdir(parents=True, exist_ok=True)
        given = {"{recording}": [str(recording)], "{folder}": [str(place.resolve())]}
        run_command(words_of(command, given), str(place))
        if (place / "report.html").is_file():
            pages[case.name] = f"lost/{case.name}/report.html"
    return pages
