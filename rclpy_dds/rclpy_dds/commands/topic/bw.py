"""Display bandwidth used by topic."""

from __future__ import annotations

import argparse
import time
from collections import deque

from rclpy_dds.commands.common import add_watched, watch


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_watched(parser, 100)


def main(args: argparse.Namespace) -> None:
    """Print the bandwidth once a second."""
    sizes: deque[tuple[float, int]] = deque(maxlen=max(2, args.window))
    watch(args, lambda data, _: sizes.append((time.monotonic(), len(data))), lambda: summary(sizes, time.monotonic()))


def summary(sizes: deque[tuple[float, int]], now: float) -> str:
    """Return what `ros2 topic bw` prints of messages' times [s] and sizes [bytes]."""
    if len(sizes) < 2:
        return ""
    each = [size for _, size in sizes]
    return (
        f"{_bytes(sum(each) / (now - sizes[0][0]))}/s from {len(each)} messages\n"
        f"\tMessage size mean: {_bytes(sum(each) / len(each))} min: {_bytes(min(each))} max: {_bytes(max(each))}\n"
    )


def _bytes(count: float) -> str:
    for factor, unit in ((1e6, "MB"), (1e3, "KB")):
        if count >= factor:
            return f"{count / factor:.2f} {unit}"
    return f"{count:.0f} B"
