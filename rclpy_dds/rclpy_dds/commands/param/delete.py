"""Delete parameter."""

from __future__ import annotations

import argparse

from rcl_interfaces.msg import Parameter

from rclpy_dds.commands.param_common import add_node_arguments, set_one


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_name", help="Name of the parameter")


def main(args: argparse.Namespace) -> str | None:
    """Set the parameter to nothing, which undeclares it, and print the outcome."""
    nothing = Parameter(name=args.parameter_name)
    return set_one(args, nothing, "Deleted parameter successfully", "Deleting parameter failed")
