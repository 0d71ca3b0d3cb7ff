"""Output a service's type."""

from __future__ import annotations

import argparse

from rclpy_dds.commands.common import add_spin_time, command_node, wait_in_graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("service_name", help="Name of the ROS service to get type (e.g. '/talker/list_parameters')")


def main(args: argparse.Namespace) -> int:
    """Print the type."""
    name = "/" + args.service_name.lstrip("/")
    with command_node() as node:
        types = wait_in_graph(node, lambda: dict(node.get_service_names_and_types()).get(name), args.spin_time)
        if not types:
            return 1
        print(*types, sep="\n")
    return 0
