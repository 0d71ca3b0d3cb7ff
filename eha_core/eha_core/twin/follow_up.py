"""What is done about a departure while the twin goes on: it is named, and the seconds about it are recorded."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path

from eha_core.background import Background, Done
from eha_core.errors import EhaError, RecordingError
from eha_core.twin.comparison import Comparison
from eha_core.twin.departures import Departures
from eha_core.twin.excerpt import Excerpt
from eha_core.twin.explanation import Explanation
from eha_core.twin.naming import explain, prepare
from eha_core.twin.snapshot import Snapshots, write_snapshot

PATIENCE = 4.0
"""s for which an end waits for what is under way: `ros2 launch` kills what has not ended after five."""

FAILED = {prepare: "departures may not be named", explain: "the departure is not named", write_snapshot: "no snapshot"}
"""What it means that one of them fails."""

News = Explanation | Path | EhaError


class FollowUp:
    """Names departures and writes snapshots in a second process, so that nobody waits for either.

    Args:
        is_naming: whether departures are named.
        folder: where snapshots go; empty: none are written.
        snapshots: which seconds they hold.

    Raises EhaError where the folder cannot be written to.
    """

    def __init__(self, is_naming: bool, folder: str, snapshots: Snapshots) -> None:
        if folder:
            _require_folder(Path(folder))
        self._departures = Departures() if is_naming else None
        self._folder, self._snapshots = folder, snapshots
        self._parameters: Mapping[str, float] = {}
        self._departs = False
        self._unwritten: deque[tuple[str, Excerpt, Mapping[str, float]]] = deque()
        self._background: Background | None = None
        self.explanation: Explanation | None = None
        """Of what departs now; None where nothing does, or it is not known yet."""
        self.snapshot: Path | None = None
        """The last one written."""

    def take(self, comparison: Comparison, kept: Sequence[Excerpt], parameters: Mapping[str, float]) -> None:
        """Take a comparison, the windows that the twin keeps, and its parameters."""
        self._departs, self._parameters = bool(comparison.departs), dict(parameters)
        if not self._departs:
            self.explanation = None
        if self._departures is None and not self._folder:
            return
        if self._background is None:  # with the first window: while nodes start, each needs the machine
            self._background = Background(prepare)
        if self._departures is not None:
            departure = self._departures.take(comparison, kept, self._parameters)
            if departure is not None:
                self._background.submit(explain, departure)
        if self._folder and (excerpt := self._snapshots.take(comparison, kept)):
            self._unwritten.append((self._folder, excerpt, self._parameters))
            self._background.submit(write_snapshot, *self._unwritten[-1])

    def collect(self) -> list[News]:
        """What was found, written or failed since the last call; it returns at once. Call it regularly."""
        return self._news(self._background.results()) if self._background else []

    def close(self) -> list[News]:
        """End, and write here what was not written yet, the snapshot under way as it is; as `collect`."""
        if self._background is None:
            return []
        news = self._news(self._background.close(PATIENCE))
        self._background = None
        if excerpt := self._snapshots.finish():
            self._unwritten.append((self._folder, excerpt, self._parameters))
        return news + self._news([(write_snapshot, _written(*one)) for one in tuple(self._unwritten)])

    def _news(self, done: Sequence[Done]) -> list[News]:
        news: list[News] = []
        for function, outcome in done:
            if function is write_snapshot:
                self._unwritten.popleft()
            if isinstance(outcome, Exception):
                news.append(EhaError(f"{FAILED[function]}: {outcome}"))
            elif function is explain:
                self.explanation = outcome if self._departs else None
                news.append(outcome)
            elif function is write_snapshot:
                self.snapshot = outcome
                news.append(outcome)
        return news


def _written(folder: str, excerpt: Excerpt, parameters: Mapping[str, float]) -> Path | RecordingError:
    try:
        return write_snapshot(folder, excerpt, parameters)
    except RecordingError as error:
        return error


def _require_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EhaError(f"folder {folder}: cannot be made ({error.strerror}); name another one") from error
    if not os.access(folder, os.W_OK):
        raise EhaError(f"folder {folder}: nothing may be written there; name another one")
