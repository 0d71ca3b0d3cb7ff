"""Run a package specific executable."""

from __future__ import annotations

import argparse
import os
import shlex
import sys

from ament_index_python.packages import get_package_prefix

from rclpy_dds.commands.main import CommandError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this command's options."""
    parser.add_argument("--prefix", help="Prefix command, which should go before the executable")
    parser.add_argument("package_name", help="Name of the ROS package")
    parser.add_argument("executable_name", help="Name of the executable")
    parser.add_argument("argv", nargs=argparse.REMAINDER, help="Pass arbitrary arguments to the executable")


def executables(package: str) -> dict[str, str]:
    """Return a package's executables by name.

    Raises:
        CommandError: there is no such package.
    """
    try:
        folder = os.path.join(get_package_prefix(package), "lib", package)
    except (LookupError, ValueError):
        raise CommandError(f"Package '{package}' not found") from None
    if not os.path.isdir(folder):
        return {}
    paths = {name: os.path.join(folder, name) for name in sorted(os.listdir(folder))}
    return {name: path for name, path in paths.items() if os.path.isfile(path) and os.access(path, os.X_OK)}


def find_executable(package: str, name: str) -> str:
    """Return the path of a package's executable.

    Raises:
        CommandError: there is no such package or executable.
    """
    found = executables(package)
    if name not in found:
        known = f"; {package} has: {', '.join(found)}" if found else ""
        raise CommandError(f"No executable found: '{name}' in package '{package}'{known}")
    return found[name]


def main(args: argparse.Namespace) -> None:
    """Become the executable, so that signals and exit status are its own."""
    path = find_executable(args.package_name, args.executable_name)
    command = [*shlex.split(args.prefix or ""), path, *args.argv]
    sys.stdout.flush()
    os.execvp(command[0], command)
