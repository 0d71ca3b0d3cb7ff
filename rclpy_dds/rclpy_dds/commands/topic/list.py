"""Output a list of available topics."""

from __future__ import annotations

import argparse

from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from rclpy_dds.commands.common import add_spin_time, command_node, discover


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("-t", "--show-types", action="store_true", help="Additionally show the topic type")
    parser.add_argument(
        "-c", "--count-topics", action="store_true", help="Only display the number of topics discovered"
    )
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")
    parser.add_argument("-v", "--verbose", action="store_true", help="List full details about each topic")


def main(args: argparse.Namespace) -> None:
    """Print the topics."""
    with command_node() as node:
        discover(node, args)
        found = node.get_topic_names_and_types()
        if not args.include_hidden_topics:
            found = [(name, types) for name, types in found if not topic_or_service_is_hidden(name)]
        if args.count_topics:
            print(len(found))
        elif args.verbose:
            for title, count, what in (
                ("Published topics:", node.count_publishers, "publisher"),
                ("Subscribed topics:", node.count_subscribers, "subscriber"),
            ):
                _print_details(node, title, count, what, found)
        else:
            for name, types in found:
                print(f"{name} [{', '.join(types)}]" if args.show_types else name)


def _print_details(node: Node, title: str, count: object, what: str, found: list[tuple[str, list[str]]]) -> None:
    print(title)
    for name, types in found:
        number = count(name)  # type: ignore[operator]
        if number:
            print(f" * {name} [{', '.join(types)}] {number} {what}{'s' if number > 1 else ''}")
    print()
