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
    found = {name: parameter_value_to_python(value) for name, value in zip(names, values, strict=True)}
    print(yaml.dump({target: {"ros__parameters": nested(found)}}, default_flow_style=False))
    return None


def nested(values: dict[str, Any]) -> dict[str, Any]:
    """Return parameters as a file groups them; a group called like a parameter stays in its members' dotted names."""
    groups: dict[str, Any] = {}
    for name, value in values.items():
        place, path, rest = groups, "", name
        while "." in rest:
            head, _, tail = rest.partition(".")
            path = f"{path}.{head}" if path else head
            if path in values:
                break
            place, rest = place.setdefault(head, {}), tail
        place[rest] = value
    return groups
