"""Show descriptive information about declared parameters."""

from __future__ import annotations

import argparse
from typing import Any

from rclpy_dds.commands.common import command_node
from rclpy_dds.commands.param_common import TYPE_NAMES, add_node_arguments, describe, find_node


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_names", nargs="+", help="Names of the parameters")


def main(args: argparse.Namespace) -> str | None:
    """Print the descriptors."""
    with command_node() as node:
        descriptors = describe(node, find_node(node, args), args.parameter_names, args.timeout)
    if not descriptors:
        return f"Parameter not declared: one of {', '.join(args.parameter_names)}"
    for descriptor in descriptors:
        _print(descriptor)
    return None


def _print(descriptor: Any) -> None:
    print("Parameter name:", descriptor.name)
    print("  Type:", TYPE_NAMES[descriptor.type])
    if descriptor.description:
        print("  Description:", descriptor.description)
    ranges = [*descriptor.integer_range, *descriptor.floating_point_range]
    if not (ranges or descriptor.read_only or descriptor.additional_constraints):
        return
    print("  Constraints:")
    if descriptor.read_only:
        print("    Read only: true")
    for allowed in ranges:
        print("    Min value:", allowed.from_value)
        print("    Max value:", allowed.to_value)
        if allowed.step:
            print("    Step:", allowed.step)
    if descriptor.additional_constraints:
        print("    Additional constraints:", descriptor.additional_constraints)
