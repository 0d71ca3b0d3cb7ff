"""Get parameter."""

from __future__ import annotations

import argparse

from rclpy.parameter import parameter_value_to_python

from rclpy_dds.commands.common import command_node
from rclpy_dds.commands.param_common import LABELS, TYPE_NAMES, add_node_arguments, find_node, get


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_name", help="Name of the parameter")
    parser.add_argument("--hide-type", action="store_true", help="Hide the type information")


def main(args: argparse.Namespace) -> str | None:
    """Print the value."""
    with command_node() as node:
        values = get(node, find_node(node, args), [args.parameter_name], args.timeout)
    if not values:
        return "Parameter not set"
    kind = TYPE_NAMES[values[0].type]
    value = parameter_value_to_python(values[0])
    if kind == "not set":
        print("Parameter not set.")
    elif args.hide_type:
        print(value)
    else:
        print(LABELS[kind], value)
    return None
