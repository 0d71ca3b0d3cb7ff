"""Whether somebody pressed a key on the terminal that a node was started from."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty


class Keyboard:
    """The terminal's keys, one by one and not shown; where standard input is no terminal, none is ever pressed."""

    def __init__(self) -> None:
        self._descriptor: int | None = None
        if sys.stdin is not None and sys.stdin.isatty() and os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp():
            self._descriptor = sys.stdin.fileno()
            self._saved = termios.tcgetattr(self._descriptor)
            tty.setcbreak(self._descriptor)

    @property
    def is_there(self) -> bool:
        """Whether a key can be pressed."""
        return self._descriptor is not None

    def pressed(self) -> bool:
        """Whether a key was pressed since the last call."""
        if self._descriptor is None or not select.select([self._descriptor], [], [], 0.0)[0]:
            return False
        return bool(os.read(self._descriptor, 1024))

    def close(self) -> None:
        """Leave the terminal as it was."""
        if self._descriptor is not None:
            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._saved)
            self._descriptor = None
