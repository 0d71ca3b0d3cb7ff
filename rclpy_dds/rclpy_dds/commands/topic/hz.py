"""Print the average publishing rate to screen."""

from __future__ import annotations

import argparse
import statistics
import time
from collections import deque

from rclpy_dds.commands.common import add_spin_time, command_node, offered_qos, spin, topic_type
from rclpy_dds.commands.values import load_class


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')")
    parser.add_argument(
        "--window", "-w", type=int, default=10000, help="window size, in # of messages (default: 10000)"
    )
    parser.add_argument("--wall-time", action="store_true", help="calculates rate using wall time, as is done anyway")


def main(args: argparse.Namespace) -> str | None:
    """Print the rate once a second."""
    with command_node() as node:
        name = topic_type(node, args.topic_name, None)
        assert name is not None
        rates = Rates(args.window)
        node.create_subscription(
            load_class(name, "msg"),
            args.topic_name,
            lambda _: rates.add(time.monotonic()),
            offered_qos(node, args.topic_name),
            raw=True,
        )
        node.create_timer(1.0, lambda: print(rates.summary(), end="", flush=True))
        spin(node)
    return None


class Rates:
    """The times between the last messages."""

    def __init__(self, window: int) -> None:
        self._deltas: deque[float] = deque(maxlen=max(1, window))
        self._last: float | None = None
        self._fresh = False

    def add(self, now: float) -> None:
        """Note a message at a time in seconds."""
        if self._last is not None:
            self._deltas.append(now - self._last)
        self._last = now
        self._fresh = True

    def summary(self) -> str:
        """Return what `ros2 topic hz` prints; nothing when no message came since the last time."""
        if not self._fresh or not self._deltas:
            return ""
        self._fresh = False
        mean = statistics.fmean(self._deltas)
        rate = 1.0 / mean if mean > 0.0 else 0.0
        return (
            f"average rate: {rate:.3f}\n\tmin: {min(self._deltas):.3f}s max: {max(self._deltas):.3f}s "
            f"std dev: {statistics.pstdev(self._deltas):.5f}s window: {len(self._deltas) + 1}\n"
        )
