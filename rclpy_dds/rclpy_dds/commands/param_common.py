"""What the parameter verbs share."""

from __future__ import annotations

import argparse
from typing import Any

from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node

from rclpy_dds.commands.common import add_spin_time, call, command_node, full_node_names, wait_in_graph
from rclpy_dds.errors import CommandError

TYPE_NAMES = {
    getattr(ParameterType, f"PARAMETER_{name.upper().replace(' ', '_')}"): name
    for name in (
        "not set", "bool", "integer", "double", "string",
        "byte array", "bool array", "integer array", "double array", "string array",
    )
}  # fmt: skip
LABELS = {
    "bool": "Boolean value is:", "integer": "Integer value is:", "double": "Double value is:",
    "string": "String value is:", "byte array": "Byte values are:", "bool array": "Boolean values are:",
    "integer array": "Integer values are:", "double array": "Double values are:", "string array": "String values are:",
}  # fmt: skip


def add_node_arguments(parser: argparse.ArgumentParser, *, optional: bool = False) -> None:
    """Add the node's name and the options about finding it."""
    add_spin_time(parser)
    parser.add_argument("node_name", nargs="?" if optional else None, help="Name of the ROS node")
    parser.add_argument("--include-hidden-nodes", action="store_true", help="Consider hidden nodes as well")
    parser.add_argument(
        "--timeout", metavar="N", type=float, default=1.0, help="Wait for N seconds until node becomes available"
    )


def find_node(node: Node, args: argparse.Namespace) -> str:
    """Return the full name of the node asked for as soon as it is there.

    Raises:
        CommandError: it is not there in time.
    """
    wanted = "/" + args.node_name.lstrip("/")
    if not wait_in_graph(node, lambda: wanted in full_node_names(node, True), max(args.timeout, args.spin_time)):
        raise CommandError("Node not found")
    return wanted


def get(node: Node, target: str, names: list[str], timeout: float) -> list[Any]:
    """Return the values of a node's parameters; an empty list when one is not declared."""
    return list(
        call(node, GetParameters, f"{target}/get_parameters", GetParameters.Request(names=names), timeout).values
    )


def describe(node: Node, target: str, names: list[str], timeout: float) -> list[Any]:
    """Return the descriptors of a node's parameters; an empty list when one is not declared."""
    request = DescribeParameters.Request(names=names)
    return list(call(node, DescribeParameters, f"{target}/describe_parameters", request, timeout).descriptors)


def list_names(node: Node, target: str, prefixes: list[str], timeout: float) -> list[str]:
    """Return the names of a node's parameters, sorted."""
    request = ListParameters.Request(prefixes=prefixes)
    return sorted(call(node, ListParameters, f"{target}/list_parameters", request, timeout).result.names)


def set_one(args: argparse.Namespace, parameter: Any, done: str, failed: str) -> str | None:
    """Set one parameter of the node asked for; print what was done, or return what failed, with the node's reason."""
    with command_node() as node:
        target = find_node(node, args)
        request = SetParameters.Request(parameters=[parameter])
        result = call(node, SetParameters, f"{target}/set_parameters", request, args.timeout).results[0]
    reason = f": {result.reason}" if result.reason else ""
    if not result.successful:
        return f"{failed}{reason}"
    print(f"{done}{reason}")
    return None
