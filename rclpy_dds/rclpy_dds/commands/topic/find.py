"""Output a list of available topics of a given type."""

from __future__ import annotations

import argparse

from rclpy.node import Node

from rclpy_dds.commands.common import add_found, print_found


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_found(parser, "topic")


def main(args: argparse.Namespace) -> None:
    """Print the topics."""
    print_found(args, args.topic_type, Node.get_topic_names_and_types)
