"""Load parameter file for a node."""

from __future__ import annotations

import argparse
import sys

from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from rclpy_dds import arguments
from rclpy_dds.commands.common import call, command_node
from rclpy_dds.commands.param_common import add_node_arguments, find_node


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)
    parser.add_argument("parameter_file", help="Parameter file")
    parser.add_argument("--no-use-wildcard", action="store_true", help="Do not load parameters in the '/**' namespace")


def main(args: argparse.Namespace) -> int | str:
    """Set what the file says and print each outcome."""
    rules = arguments.read_parameter_file(args.parameter_file)
    failed = False
    with command_node() as node:
        target = find_node(node, args)
        chosen = {
            rule.name: rule.value for rule in rules
            if arguments.matches(rule.pattern, target) and not (args.no_use_wildcard and rule.pattern == "/**")
        }  # fmt: skip
        if not chosen:
            return f"{args.parameter_file} has no parameters for {target}"
        messages = [Parameter(name, value=value).to_parameter_msg() for name, value in chosen.items()]
        request = SetParameters.Request(parameters=messages)
        results = call(node, SetParameters, f"{target}/set_parameters", request, args.timeout).results
        for name, result in zip(chosen, results, strict=True):
            reason = f": {result.reason}" if result.reason else ""
            if result.successful:
                print(f"Set parameter {name} successful{reason}")
            else:
                print(f"Set parameter {name} failed{reason}", file=sys.stderr)
                failed = True
    return int(failed)
