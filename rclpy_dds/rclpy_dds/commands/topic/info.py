"""Print information about a topic."""

from __future__ import annotations

import argparse
from typing import Any

from rclpy_dds.commands.common import add_spin_time, command_node, topic_type, wait_in_graph

_UNKNOWN = "_NODE_NAME_UNKNOWN_"


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

        def publishers() -> list[Any]:
            return list(node.get_publishers_info_by_topic(args.topic_name))

        def subscriptions() -> list[Any]:
            return list(node.get_subscriptions_info_by_topic(args.topic_name))

        # A node tells its name on a topic, which may come after its endpoints.
        wait_in_graph(
            node, lambda: all(one.node_name != _UNKNOWN for one in publishers() + subscriptions()), args.spin_time
        )
        print(f"Type: {name}", end=end)
        for title, infos in (("Publisher", publishers()), ("Subscription", subscriptions())):
            print(f"{title} count: {len(infos)}", end=end)
            for info in infos if args.verbose else ():
                print(info, end=end)
    return None
