"""A diagnosis in a process of its own, which can be watched and stopped."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

FILES = (
    "topics.yaml", "nominal.yaml", "report.html", "diagnosis.json", "fitted.yaml", "comparison.mcap",
    "next_experiment.yaml", "next_experiment.launch.yaml",
)  # fmt: skip
"""What can be downloaded of a diagnosis, where it is there."""
MOST_LINES = 200
"""Lines of progress that are handed over at once."""
_PATIENCE = 5.0
"""s that a process has to end when it is asked to."""
_LINE = re.compile(r"\s*(?P<seconds>[\d.]+) s\s+\[(?P<bar>[#>.]*)\] (?P<phase>[^:]+): (?P<message>.*)")
_PROGRESS = re.compile(r"^eha diagnose: \d+ s \[")
_LOG, _SAID, _WARNED = "progress.log", "account.txt", "warnings.txt"


class Run:
    """`eha diagnose` of one recording into a folder.

    Args:
        recording: the file.
        folder: where `topics.yaml`, and `nominal.yaml` where there is one, lie, and the report goes.
    """

    def __init__(self, recording: Path, folder: Path) -> None:
        self._folder = folder
        self.stopped = False
        words = [str(recording.absolute()), "--topics", str(folder / "topics.yaml"), "--out", str(folder)]
        if (folder / "nominal.yaml").exists():
            words += ["--nominal", str(folder / "nominal.yaml")]
        words += ["--log", str(folder / _LOG)]
        command = [sys.executable, "-m", "eha_core.cli", "diagnose", *words]
        (folder / _LOG).write_text("")
        with (folder / _SAID).open("wb") as said, (folder / _WARNED).open("wb") as warned:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=said, stderr=warned, start_new_session=True
            )

    @property
    def is_running(self) -> bool:
        """Whether the diagnosis is still at work."""
        return self._process.poll() is None

    def stop(self) -> None:
        """End the process, and whatever it started."""
        if not self.is_running:
            return
        self.stopped = True
        for sign in (signal.SIGTERM, signal.SIGKILL):
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, sign)
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(_PATIENCE)
                return

    def state(self, start: int = 0) -> dict[str, Any]:
        """How far it is: lines of progress from byte `start` of its log on, and what it said when it has ended."""
        is_running = self.is_running
        with (self._folder / _LOG).open("rb") as log:
            log.seek(start)
            new = log.read()
        whole = new[: new.rfind(b"\n") + 1]
        lines = whole.decode("utf-8", "replace").splitlines()[-MOST_LINES:]
        warned = (self._folder / _WARNED).read_text("utf-8", "replace").splitlines()
        return {
            "running": is_running, "stopped": self.stopped, "status": self._process.poll(),
            "next": start + len(whole), "progress": [one for line in lines if (one := _progress(line)) is not None],
            "warnings": [line.removeprefix("eha diagnose: ") for line in warned if not _PROGRESS.match(line)],
            "account": "" if is_running else (self._folder / _SAID).read_text("utf-8", "replace"),
            "files": [] if is_running else files_in(self._folder),
        }  # fmt: skip


def files_in(folder: Path) -> list[str]:
    """The files of a folder that can be downloaded."""
    return [name for name in FILES if (folder / name).is_file()]


def _progress(line: str) -> dict[str, Any] | None:
    match = _LINE.fullmatch(line)
    if match is None:
        return None
    message, _, left = match["message"].partition("; left: ")
    return {
        "seconds": float(match["seconds"]), "done": match["bar"].count("#"), "of": len(match["bar"]),
        "phase": match["phase"], "message": message, "left": left,
    }  # fmt: skip
