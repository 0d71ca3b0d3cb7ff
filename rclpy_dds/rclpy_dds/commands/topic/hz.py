"""Print the average publishing rate to screen."""

from __future__ import annotations

import argparse
import statistics
import time
from collections import deque
from collections.abc import Callable

from rclpy_dds.commands.common import add_watched, watch


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_watched(parser, 10000)
    parser.add_argument("--wall-time", action="store_true", help="calculates rate using wall time, as is done anyway")


def main(args: argparse.Namespace) -> None:
    """Print the rate once a second."""
    rates = Rates(args.window)
    watch(args, lambda *_: rates.add(time.monotonic()), rates.summary)


class Spread:
    """The last of some times [s], and what ros2 prints of them."""

    def __init__(self, window: int) -> None:
        self._values: deque[float] = deque(maxlen=max(1, window))

    def note(self, value: float) -> None:
        """Take one more."""
        self._values.append(value)

    def lines(self, head: Callable[[float], str], more: int = 0) -> str:
        """Return a line about their mean, and one about how they spread; `more` messages than times were needed."""
        if not self._values:
            return ""
        return (
            f"{head(statistics.fmean(self._values))}\n"
            f"\tmin: {min(self._values):.3f}s max: {max(self._values):.3f}s "
            f"std dev: {statistics.pstdev(self._values):.5f}s window: {len(self._values) + more}\n"
        )


class Rates(Spread):
    """The times between the last messages."""

    def __init__(self, window: int) -> None:
        super().__init__(window)
        self._last: float | None = None
        self._fresh = False

    def add(self, now: float) -> None:
        """Note a message at a time in seconds."""
        if self._last is not None:
            self.note(now - self._last)
        self._last = now
        self._fresh = True

    def summary(self) -> str:
        """Return what `ros2 topic hz` prints; nothing when no message came since the last time."""
        if not self._fresh:
            return ""
        self._fresh = False
        return self.lines(lambda mean: f"average rate: {1.0 / mean if mean > 0.0 else 0.0:.3f}", 1)
