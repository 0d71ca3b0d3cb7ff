"""Dump the parameters of a node in a YAML file format."""

from __future__ import annotations

import argparse
from typing import Any

import yaml
from rclpy.parameter import parameter_value_to_python

from rclpy_dds.commands.common import command_node
from rclpy_dds.commands.param_common import add_node_arguments, find_node, get, list_names


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> str | None:
    """Print the file."""
    with command_node() as node:
        target = find_node(node, args)
        names = list_names(node, target, [], args.timeout)
        values = get(node, target, names, args.timeout)
        if len(values) != len(names):
            return f"{target}: a parameter has no value"
    nested: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        *groups, last = name.split(".")
        place = nested
        for group in groups:
            place = place.setdefault(group, {})
        place[last] = parameter_value_to_python(value)
    print(yaml.dump({target: {"ros__parameters": nested}}, default_flow_style=False))
    return None
