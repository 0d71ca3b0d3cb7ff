"""Output a list of available nodes."""

from __future__ import annotations

import argparse

from rclpy_dds.commands.common import add_spin_time, command_node, discover, full_node_names


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("-a", "--all", action="store_true", help="Display all nodes even hidden ones")
    parser.add_argument("-c", "--count-nodes", action="store_true", help="Only display the number of nodes discovered")


def main(args: argparse.Namespace) -> None:
    """Print the nodes."""
    with command_node() as node:
        discover(node, args)
        names = full_node_names(node, args.all)
    if args.count_nodes:
        print(len(names))
        return
    if len(set(names)) < len(names):
        print(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, "
            "which can have unintended side effects."
        )
    if names:
        print(*names, sep="\n")
