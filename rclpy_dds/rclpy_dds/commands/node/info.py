"""Output information about a node."""

from __future__ import annotations

import argparse

from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from rclpy_dds.commands.common import add_spin_time, command_node, full_node_names, wait_in_graph, wait_until


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_spin_time(parser)
    parser.add_argument("node_name", help="Node name to request information")
    parser.add_argument(
        "--include-hidden", action="store_true", help="Display hidden topics, services, and actions as well"
    )


def main(args: argparse.Namespace) -> str | None:
    """Print what the node publishes, subscribes to, offers and calls."""
    wanted = "/" + args.node_name.lstrip("/")
    with command_node() as node:
        if not wait_in_graph(node, lambda: wanted in full_node_names(node, True), args.spin_time):
            return f"Unable to find node '{args.node_name}'"
        wait_until(lambda: False, 0.1)  # endpoints are discovered right after their node
        namespace, _, name = wanted.rpartition("/")
        print(wanted)
        for title, query in (
            ("Subscribers", node.get_subscriber_names_and_types_by_node),
            ("Publishers", node.get_publisher_names_and_types_by_node),
            ("Service Servers", node.get_service_names_and_types_by_node),
            ("Service Clients", node.get_client_names_and_types_by_node),
        ):
            print(f"  {title}:")
            for entry, types in query(name, namespace or "/"):
                if args.include_hidden or not topic_or_service_is_hidden(entry):
                    print(f"    {entry}: {', '.join(types)}")
            if not title.startswith("Sub") and not title.startswith("Pub"):
                print()
        print("  Action Servers:\n\n  Action Clients:")
    return None
