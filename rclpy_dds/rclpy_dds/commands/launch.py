"""Run a launch file."""

from __future__ import annotations

import argparse
import os

from ament_index_python.packages import get_package_share_directory

from rclpy_dds.errors import CommandError
from rclpy_dds.launching.description import LaunchError, declared_arguments, read
from rclpy_dds.launching.processes import run

_SUFFIXES = (".yaml", ".yml")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this command's options."""
    parser.add_argument("-p", "--print", "--print-description", action="store_true", help="Print what would be started")
    parser.add_argument(
        "-s", "--show-args", "--show-arguments", action="store_true", help="Show the launch file's arguments"
    )
    parser.add_argument("-n", "--noninteractive", action="store_true", help="Accepted for compatibility")
    parser.add_argument("-d", "--debug", action="store_true", help="Accepted for compatibility")
    parser.add_argument("package_name", help="Name of the ROS package which contains the launch file, or its path")
    parser.add_argument("launch_file_name", nargs="?", help="Name of the launch file")
    parser.add_argument("launch_arguments", nargs="*", help="Arguments to the launch file; '<name>:=<value>'")


def main(args: argparse.Namespace) -> int | str:
    """Start what the launch file describes and wait for it."""
    path, given = _find(args)
    values = {}
    for text in given:
        name, separator, value = text.partition(":=")
        if not separator or not name:
            return f"malformed launch argument '{text}', expected format '<name>:=<value>'"
        values[name] = value
    try:
        if args.show_args:
            _show(declared_arguments(path))
            return 0
        description = read(path, values)
    except LaunchError as error:
        return str(error)
    if args.print:
        for process in description:
            print(process.label, " ".join(process.command))
        return 0
    return run(description)


def _find(args: argparse.Namespace) -> tuple[str, list[str]]:
    """Return the launch file's path and what follows it on the command line."""
    rest = [text for text in (args.launch_file_name, *args.launch_arguments) if text]
    if os.path.isfile(args.package_name):
        path = args.package_name
    else:
        if not rest:
            raise CommandError(
                f"{args.package_name!r} is no launch file; name one, or a package and one of its launch files"
            )
        try:
            share = get_package_share_directory(args.package_name)
        except LookupError as error:
            raise CommandError(str(error)) from None
        name = rest.pop(0)
        found = sorted(os.path.join(root, name) for root, _, files in os.walk(share) if name in files)
        if not found:
            raise CommandError(
                f"file '{name}' was not found in the share directory of package '{args.package_name}' at {share}"
            )
        path = found[0]
    if not path.endswith(_SUFFIXES):
        raise CommandError(
            f"{path}: rclpy_dds launches YAML files only; install ROS 2 for others (https://docs.ros.org)"
        )
    return path, rest


def _show(arguments: list[tuple[str, str | None, str]]) -> None:
    print("Arguments (pass arguments as '<name>:=<value>'):\n")
    if not arguments:
        print("  No arguments.")
    for name, default, description in arguments:
        print(f"    '{name}':\n        {description or 'no description given'}")
        if default is not None:
            print(f"        (default: '{default}')")
        print()
