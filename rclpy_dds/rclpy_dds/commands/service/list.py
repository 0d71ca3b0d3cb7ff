"""Output a list of available services."""

from __future__ import annotations

import argparse

from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from rclpy_dds.commands.common import add_spin_time, command_node, discover


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the service type")
    parser.add_argument("-c", "--count-services", action="store_true", help="Only display the number of services")
    parser.add_argument("--include-hidden-services", action="store_true", help="Consider hidden services as well")


def main(args: argparse.Namespace) -> None:
    """Print the services."""
    with command_node() as node:
        discover(node, args)
        found = node.get_service_names_and_types()
        if not args.include_hidden_services:
            found = [(name, types) for name, types in found if not topic_or_service_is_hidden(name)]
        if args.count_services:
            print(len(found))
            return
        for name, types in found:
            print(f"{name} [{', '.join(types)}]" if args.show_types else name)
