"""Output the interface definition."""

from __future__ import annotations

import argparse

from rclpy_dds.interfaces import store
from rclpy_dds.interfaces.text import message_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("type", help="Show an interface definition (e.g. 'example_interfaces/msg/String')")


def main(args: argparse.Namespace) -> str | None:
    """Print the definition."""
    parts = args.type.split("/")
    if len(parts) == 2:
        parts.insert(1, "msg")
    if len(parts) != 3 or parts[1] not in ("msg", "srv"):
        return f"{args.type!r} is no type name; write package/msg/Name or package/srv/Name"
    name = "/".join(parts)
    if parts[1] == "msg":
        print(message_text(store.message(name)), end="")
        return None
    request, response = store.service(name)
    print(f"{message_text(request)}---\n{message_text(response)}", end="")
    return None
