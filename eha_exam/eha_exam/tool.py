"""A tool is a command line. It runs on one core in an empty folder, for a limited time; its processor time counts."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from threading import Event, Timer

from eha_exam.document import read_document
from eha_exam.errors import ExamError
from eha_exam.scoring import Answer

LONGEST = 600.0
"""s; a tool that takes longer for one recording has failed on it."""

STOPPED = (signal.SIGHUP, signal.SIGINT, signal.SIGTERM)
"""A tool that ends of these has not answered."""

ONE_CORE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""Holds a tool's numerical libraries to one core: `--jobs` says how many tools work at once, and times are compared."""


def words_of(command: str, replaced: Mapping[str, Sequence[str]]) -> list[str]:
    """The words of a command: those of `replaced` become what stands for them, {python} this interpreter's path."""
    words: list[str] = []
    for word in shlex.split(command):
        words += replaced.get(word, [word.replace("{python}", sys.executable)])
    return words


def run_tool(command: Sequence[str]) -> Answer:
    """Run a tool in an empty folder; the word {answer} becomes the path where it is to write its diagnosis.

    Its seconds are the processor time of the tool and of what it started and waited for: what else runs on the machine,
    or ends meanwhile, is no part of them.
    """
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch) / "diagnosis.json"
        words = [word.replace("{answer}", str(target)) for word in command]
        status, seconds, message = run_command(words, scratch)
        diagnosis, fault = read_document(target)
    return Answer(diagnosis, status, seconds, message or fault)


def run_command(words: Sequence[str], folder: str, recordings: int = 1) -> tuple[int, float, str]:
    """Exit status, processor time [s] and the end of what was written to stderr, of a command for so many recordings.

    ExamError where it cannot be started, or was stopped from outside.
    """
    environment = {**os.environ, **ONE_CORE}
    longest = LONGEST * recordings
    with tempfile.TemporaryFile() as said:
        try:
            process = subprocess.Popen(words, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=said)
        except OSError as error:
            raise ExamError(f"{words[0]}: cannot be started ({error.strerror}); check the tool's command") from None
        overdue, seconds = _wait(process, longest)
        said.seek(0)
        message = said.read().decode(errors="replace")[-2000:]
    if overdue:
        return -1, seconds, f"took longer than {longest:g} s"
    if -process.returncode in STOPPED:
        raise ExamError(f"{words[0]}: was stopped from outside; start the exam again, what is done stays done")
    return process.returncode, seconds, message


def _wait(process: subprocess.Popen[bytes], longest: float) -> tuple[bool, float]:
    """Whether the process had to be ended for taking longer [s], and its processor time [s]."""
    overdue = Event()

    def end() -> None:
        overdue.set()
        os.kill(process.pid, signal.SIGKILL)

    limit = Timer(longest, end)
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
