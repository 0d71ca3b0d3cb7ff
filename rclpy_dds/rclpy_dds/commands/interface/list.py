"""List all interface types available."""

from __future__ import annotations

import argparse

from rclpy_dds.interfaces import store


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("-m", "--only-msgs", action="store_true", help="Print out only the message types")
    parser.add_argument("-s", "--only-srvs", action="store_true", help="Print out only the service types")


def main(args: argparse.Namespace) -> None:
    """Print the types."""
    packages = sorted(store.package_names())
    for title, kind, skipped in (("Messages", "msg", args.only_srvs), ("Services", "srv", args.only_msgs)):
        if skipped:
            continue
        print(f"{title}:")
        for package in packages:
            for name in store.interface_names(package, kind):
                print(f"    {package}/{kind}/{name}")
