"""The progress of a diagnosis: one line on a terminal, or a line every few seconds where standard error is a file."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import TextIO

from eha_core.cli import CLEAR_LINE
from eha_core.errors import EhaError

PHASES = {
    "reading": ("reading",),
    "calibration": ("calibrating", "once more"),
    "search": (),
    "intervals": ("polishing",),
    "whole record": ("judging",),
    "report": ("writing",),
}
"""The phases of a diagnosis, and how the messages of each begin; all other messages belong to the search."""

NOW_AND_THEN = 10.0
"""s between two lines in a file (assumed: an hour's diagnosis is a screenful)."""

WIDTH = 100
"""Most characters of the line on a terminal: a longer one would wrap, and its beginning could not be cleared."""


class Progress:
    """Shows the current step and its residual.

    Args:
        long: whether a whole long record will be evaluated.
        log: a file that gets every message, with the seconds since the start.
        out: stream of the lines, standard error by default.
        clock: returns the time [s].
    """

    def __init__(
        self,
        long: bool = False,
        log: Path | None = None,
        out: TextIO | None = None,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self.long = long
        self._out = out or sys.stderr
        self._clock = clock
        self._began = self._told = clock()
        self._log = _opened(log) if log else None

    def __call__(self, message: str) -> None:
        """Show one message."""
        passed = self._clock() - self._began
        if self._log:
            print(f"{passed:7.1f} s  {self.placed(message)}", file=self._log, flush=True)
        if self._out.isatty():
            line = f"  {passed:.0f} s {self.placed(message)}"
            print(f"{CLEAR_LINE}{line[:WIDTH]}", end="", file=self._out, flush=True)
        elif self._clock() - self._told >= NOW_AND_THEN:
            self._told = self._clock()
            print(f"eha diagnose: {passed:.0f} s {self.placed(message)}", file=self._out, flush=True)

    def placed(self, message: str) -> str:
        """A message with the phases that are done and those that remain."""
        names = [name for name in PHASES if self.long or name != "whole record"]
        at = next((name for name in names if message.startswith(PHASES[name] or "\0")), "search")
        done = names.index(at)
        left = ", ".join(names[done + 1 :])
        bar = "#" * done + ">" + "." * (len(names) - done - 1)
        return f"[{bar}] {at}: {message}" + (f"; left: {left}" if left else "")

    def end(self) -> None:
        """Clear the line."""
        if self._out.isatty():
            print(CLEAR_LINE, end="", file=self._out, flush=True)
        if self._log:
            self._log.close()


def _opened(path: Path) -> TextIO:
    try:
        return path.open("w", encoding="utf-8")
    except OSError as error:
        raise EhaError(f"{path}: cannot be written ({error.strerror}); choose another --log") from error
