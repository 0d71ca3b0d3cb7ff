"""Set parameter."""

from __future__ import annotations

import argparse

from rcl_interfaces.msg import Parameter
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import get_parameter_value

from rclpy_dds.commands.common import call, command_node
from rclpy_dds.commands.param_common import add_node_arguments, find_node


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_name", help="Name of the parameter")
    parser.add_argument("value", help="Value of the parameter")


def main(args: argparse.Namespace) -> str | None:
    """Set the value and print the outcome."""
    parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
    with command_node() as node:
        target = find_node(node, args)
        request = SetParameters.Request(parameters=[parameter])
        result = call(node, SetParameters, f"{target}/set_parameters", request, args.timeout).results[0]
    if result.successful:
        print("Set parameter successful" + (f": {result.reason}" if result.reason else ""))
        return None
    return "Setting parameter failed" + (f": {result.reason}" if result.reason else "")
