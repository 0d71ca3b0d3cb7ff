"""Output a list of available services of a given type."""

from __future__ import annotations

import argparse

from rclpy.node import Node

from rclpy_dds.commands.common import add_found, print_found


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_found(parser, "service")


def main(args: argparse.Namespace) -> None:
    """Print the services."""
    print_found(args, args.service_type, Node.get_service_names_and_types)
