"""Output a list of available parameters."""

from __future__ import annotations

import argparse
import re
import sys

from rclpy_dds.commands.common import command_node, discover, full_node_names
from rclpy_dds.commands.param_common import TYPE_NAMES, add_node_arguments, describe, find_node, list_names
from rclpy_dds.errors import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser, optional=True)
    parser.add_argument(
        "--param-prefixes", nargs="+", default=[], help="Only list parameters with the provided prefixes"
    )
    parser.add_argument("--param-type", action="store_true", help="Print parameter types with parameter names")
    parser.add_argument("--filter", help="Only list parameters matching the regular expression")


def main(args: argparse.Namespace) -> int:
    """Print the parameters of one node or of all."""
    failed = False
    with command_node() as node:
        if args.node_name:
            targets = [find_node(node, args)]
        else:
            discover(node, args)
            targets = full_node_names(node, args.include_hidden_nodes)
        for target in targets:
            try:
                names = list_names(node, target, args.param_prefixes, args.timeout)
                names = [name for name in names if not args.filter or re.match(args.filter, name)]
                kinds = {}
                if args.param_type and names:
                    kinds = {d.name: TYPE_NAMES[d.type] for d in describe(node, target, names, args.timeout)}
            except CommandError as error:
                print(f"{target}: {error}", file=sys.stderr)
                failed = failed or bool(args.node_name)
                continue
            if not args.node_name:
                print(f"{target}:")
            for name in names:
                print(f"  {name} (type: {kinds[name]})" if name in kinds else f"  {name}")
    return int(failed)
