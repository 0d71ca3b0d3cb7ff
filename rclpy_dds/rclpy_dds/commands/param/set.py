"""Set parameter."""

from __future__ import annotations

import argparse

from rcl_interfaces.msg import Parameter
from rclpy.parameter import get_parameter_value

from rclpy_dds.commands.param_common import add_node_arguments, set_one


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_name", help="Name of the parameter")
    parser.add_argument("value", help="Value of the parameter")


def main(args: argparse.Namespace) -> str | None:
    """Set the value and print the outcome."""
    parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
    return set_one(args, parameter, "Set parameter successful", "Setting parameter failed")
