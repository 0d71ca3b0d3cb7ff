"""Display delay of topic from timestamp in header."""

from __future__ import annotations

import argparse
from typing import Any

from rclpy.node import Node

from rclpy_dds.commands.common import add_watched, watch
from rclpy_dds.commands.topic.hz import Spread
from rclpy_dds.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_watched(parser, 10000)


def main(args: argparse.Namespace) -> None:
    """Print the delay once a second."""
    delays = Spread(args.window)

    def add(message: Any, node: Node) -> None:
        if not hasattr(message, "header"):
            raise CommandError(f"messages of {args.topic_name} have no header; `ros2 topic hz` measures their rate")
        stamp = message.header.stamp
        delays.note((node.get_clock().now().nanoseconds - stamp.sec * 10**9 - stamp.nanosec) * 1e-9)

    watch(args, add, lambda: delays.lines(lambda mean: f"average delay: {mean:.3f}"), raw=False)
