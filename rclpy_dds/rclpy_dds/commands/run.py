"""Run a package specific executable."""

from __future__ import annotations

import argparse
import os
import shlex
import sys

from rclpy_dds.executables import find_executable


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this command's options."""
    parser.add_argument("--prefix", help="Prefix command, which should go before the executable")
    parser.add_argument("package_name", help="Name of the ROS package")
    parser.add_argument("executable_name", help="Name of the executable")
    parser.add_argument("argv", nargs=argparse.REMAINDER, help="Pass arbitrary arguments to the executable")


def main(args: argparse.Namespace) -> None:
    """Become the executable, so that signals and exit status are its own."""
    path = find_executable(args.package_name, args.executable_name)
    command = [*shlex.split(args.prefix or ""), path, *args.argv]
    sys.stdout.flush()
    os.execvp(command[0], command)
