"""Print a topic's type."""

from __future__ import annotations

import argparse

from rclpy_dds.commands.common import add_spin_time, command_node, topic_type


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to get type (e.g. '/chatter')")


def main(args: argparse.Namespace) -> int:
    """Print the type."""
    with command_node() as node:
        name = topic_type(node, args.topic_name, args.spin_time)
        if name is None:
            return 1
        print(name)
    return 0
