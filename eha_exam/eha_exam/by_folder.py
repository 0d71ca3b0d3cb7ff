"""A method: a command that is called once, with a folder of recordings and a folder for its answers."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from eha_exam.document import read_document
from eha_exam.exam_folder import Exam, Progress, keep_answer, recordings_of
from eha_exam.files import write_nominal
from eha_exam.recordings import read_recording
from eha_exam.scoring import Answer
from eha_exam.tool import run_command, words_of


def answer_by_folder(exam: Exam, method: str, command: str, progress: Progress) -> None:
    """Have a method answer, in one call, the recordings that it has not been given before.

    Its folder holds those recordings and, for each, its nominal parameters as a file of the same stem, `.yaml`. It
    writes one `<stem>.json` for each; a recording without one has failed. The processor time is shared out evenly.
    """
    missing, total = exam.unanswered(method), len(exam.names())
    progress(method, total - len(missing), total)
    if not missing:
        return
    with tempfile.TemporaryDirectory(dir=exam.folder.resolve(), prefix="method-") as place:
        given, written = Path(place) / "recordings", Path(place) / "answers"
        written.mkdir()
        _lay_out(exam, missing, given)
        words = words_of(command, {"{recordings}": [str(given)], "{answers}": [str(written)]})
        status, seconds, message = run_command(words, place, len(missing))
        for name in missing:
            stem = Path(name).stem
            document, fault = read_document(written / f"{stem}.json")
            answer = Answer(document, status, seconds / len(missing), message or fault)
            keep_answer(exam.answers(method), stem, answer)
    progress(method, total, total)


def _lay_out(exam: Exam, names: Sequence[str], folder: Path) -> None:
    """A folder of these recordings and their nominal files alone, without links that a container could not follow."""
    folder.mkdir()
    for name in names:
        first = exam.recordings / name
        for path in recordings_of(first):
            _put(path, folder / path.name)
        listed, nominal = first.with_suffix(".yaml"), (folder / name).with_suffix(".yaml")
        if listed.is_file():
            _put(listed, nominal)
        else:
            write_nominal(read_recording(first).parameters, nominal)


def _put(path: Path, target: Path) -> None:
    """The same file under another name, or a copy where the file system has no such names."""
    try:
        os.link(path, target)
    except OSError:
        shutil.copyfile(path, target)
