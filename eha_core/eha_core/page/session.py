"""What one person does on the page: a file, what its columns are, the rig's data sheet, a diagnosis."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from threading import RLock
from typing import Any

from eha_core.errors import EhaError, RecordingError
from eha_core.nominal import load_nominal
from eha_core.page.data_sheet import Sheet, sheet_of
from eha_core.page.description import certain_rows, choices, description
from eha_core.page.rows import Row, refuse_open, row_of, row_of_json, topics_text_of
from eha_core.page.run import FILES, Run, files_in
from eha_core.recording.inspection import Inspection, inspect_file
from eha_core.recording.suggestions import Suggestions, suggest
from eha_core.recording.topics_file import load_topics_file

LARGEST_YAML = 2**20
"""Bytes of a topics or nominal file; a large one has some thousand."""


class Session:
    """The state behind the page; its methods are called by one request at a time.

    Args:
        out: the folder in which each file's results get a folder.
    """

    def __init__(self, out: Path) -> None:
        self._out = out
        self._lock = RLock()
        self._file: tuple[Inspection, Suggestions] | None = None
        self._rows: list[Row] = []
        self._without: list[str] = []
        self._folder: Path | None = None
        self._nominal = ("", "")
        self._run: Run | None = None

    def open(self, path: Path) -> None:
        """Read a recording, a topics file or a nominal file.

        Raises:
            EhaError: it cannot be read, or holds nothing of use.
        """
        with self._lock:
            if path.suffix.lower() in (".yaml", ".yml"):
                self._open_yaml(path)
            else:
                self._open_recording(path)

    def _open_recording(self, path: Path) -> None:
        if self._run is not None and self._run.is_running:
            raise EhaError("a diagnosis is at work; stop it before another file")
        inspection = inspect_file(path)
        suggestions = suggest(inspection)
        if not any(field.count and not field.problem for field in inspection.fields):
            raise RecordingError(f"{path.name}: holds no numbers that could be a channel")
        self._file, self._run, self._folder = (inspection, suggestions), None, None
        self._rows, self._without = certain_rows(inspection, suggestions), []

    def _open_yaml(self, path: Path) -> None:
        if path.stat().st_size > LARGEST_YAML:
            raise EhaError(f"{path.name}: is larger than any topics or nominal file")
        text = path.read_text("utf-8", "replace")
        if not re.search(r"^channels:", text, re.MULTILINE):
            load_nominal(path)
            self._nominal = path.name, text
            return
        if self._file is None:
            raise EhaError(f"{path.name}: is a topics file; open the recording that it belongs to first")
        inspection, suggestions = self._file
        topics = load_topics_file(path, assume=True)
        rules = {**topics.channels, "time": topics.time}
        said = {name: row_of(name, rule, inspection) for name, rule in rules.items() if rule is not None}
        missing = [name for name, row in said.items() if row is None and name != "time"]
        if missing:
            raise RecordingError(f"{path.name}: {inspection.path.name} has no column for {', '.join(missing)}")
        rows = {row.channel: row for row in certain_rows(inspection, suggestions)}
        rows |= {name: row for name, row in said.items() if row is not None}
        self._without = [name for name, rule in rules.items() if rule is None]
        self._rows = [row for name, row in rows.items() if name not in self._without]

    def state(self) -> dict[str, Any]:
        """Everything that the page shows."""
        with self._lock:
            file = None if self._file is None else description(*self._file, self._rows)
            run = None if self._run is None else self._run.state()
            name, text = self._nominal
            return {
                "choices": choices(), "file": file, "without": self._without, "run": run,
                "nominal": {"name": name, "text": text} if text else None,
            }  # fmt: skip

    def say(self, rows: Sequence[Any], without: Sequence[Any]) -> str:
        """Take what the columns are, and return the topics file of it.

        Raises:
            EhaError: there is no file, or a row is not complete.
        """
        with self._lock:
            inspection, suggestions = self._opened()
            said = [row_of_json(row) for row in rows]
            left_out = [str(name) for name in without]
            refuse_open(said, left_out, {question.channel: question.text for question in suggestions.questions})
            text = topics_text_of(said, left_out, inspection)
            path = self._made_folder() / "topics.yaml"
            path.write_text(text, encoding="utf-8")
            load_topics_file(path)
            self._rows, self._without = said, left_out
            return text

    def fill_in(self, source: str, lines: Mapping[str, str]) -> Sheet:
        """Take a rig's data sheet. Raises EhaError where its lines contradict each other."""
        with self._lock:
            sheet = sheet_of(source, lines)
            if sheet.text:
                self._nominal = "nominal.yaml", sheet.text
            return sheet

    def forget_nominal(self) -> None:
        """Go on without a nominal file."""
        with self._lock:
            self._nominal = ("", "")

    def diagnose(self) -> None:
        """Begin a diagnosis. Raises EhaError where nothing was said of the columns, or one is at work."""
        with self._lock:
            inspection, _ = self._opened()
            folder = self._made_folder()
            if self._run is not None and self._run.is_running:
                raise EhaError("a diagnosis is at work already")
            if not (folder / "topics.yaml").is_file():
                raise EhaError("say what the columns are first")
            for name in FILES:
                if name not in ("topics.yaml", "nominal.yaml"):
                    (folder / name).unlink(missing_ok=True)
            nominal = folder / "nominal.yaml"
            nominal.unlink(missing_ok=True)
            if self._nominal[1]:
                nominal.write_text(self._nominal[1], encoding="utf-8")
            self._run = Run(inspection.path, folder)

    def progress(self, start: int) -> dict[str, Any]:
        """How far the diagnosis is. Raises EhaError where there is none."""
        if self._run is None:
            raise EhaError("no diagnosis was begun")
        return self._run.state(start)

    def stop(self) -> None:
        """End the diagnosis, if one is at work."""
        if self._run is not None:
            self._run.stop()

    def result(self, name: str) -> Path:
        """A file of the result by its name. Raises EhaError for any other."""
        if name not in FILES or self._folder is None or name not in files_in(self._folder):
            raise EhaError(f"there is no {name[:60]!r} to download")
        return self._folder / name

    def _opened(self) -> tuple[Inspection, Suggestions]:
        if self._file is None:
            raise EhaError("open a file first")
        return self._file

    def _made_folder(self) -> Path:
        """The folder of this file's results: a new one, so that those of another time stay."""
        if self._folder is None:
            stem = self._opened()[0].path.stem or "recording"
            for k in range(1, 10_000):
                folder = self._out / (stem if k == 1 else f"{stem}-{k}")
                try:
                    folder.mkdir(parents=True)
                except FileExistsError:
                    continue
                except OSError as error:
                    raise EhaError(f"{folder}: cannot be made ({error.strerror}); choose another --out") from error
                self._folder = folder
                break
        assert self._folder is not None
        return self._folder
