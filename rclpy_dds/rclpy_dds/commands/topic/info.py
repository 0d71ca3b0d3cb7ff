"""Print information about a topic."""

from __future__ import annotations

import argparse

from rclpy_dds.commands.common import add_spin_time, command_node, topic_type


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("topic_name", help="Name of the ROS topic to get info (e.g. '/chatter')")
    parser.add_argument("--verbose", "-v", action="store_true", help="Prints detailed information about every endpoint")


def main(args: argparse.Namespace) -> str | None:
    """Print type, counts and, if asked for, every endpoint."""
    with command_node() as node:
        name = topic_type(node, args.topic_name, args.spin_time)
        if name is None:
            return f"Unknown topic '{args.topic_name}'"
        end = "\n\n" if args.verbose else "\n"
        print(f"Type: {name}", end=end)
        for title, infos in (
            ("Publisher", node.get_publishers_info_by_topic(args.topic_name)),
            ("Subscription", node.get_subscriptions_info_by_topic(args.topic_name)),
        ):
            print(f"{title} count: {len(infos)}", end=end)
            for info in infos if args.verbose else ():
                print(info, end=end)
    return None
