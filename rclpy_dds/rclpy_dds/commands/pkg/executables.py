"""Output a list of package specific executables."""

from __future__ import annotations

import argparse

from ament_index_python.packages import get_packages_with_prefixes

from rclpy_dds.executables import executables


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add this verb's options."""
    parser.add_argument("package_name", nargs="?", help="The package name; all packages without it")
    parser.add_argument("--full-path", action="store_true", help="Show the full path of the executable")


def main(args: argparse.Namespace) -> None:
    """Print the executables, each after its package."""
    for package in [args.package_name] if args.package_name else sorted(get_packages_with_prefixes()):
        for name, path in executables(package).items():
            print(path if args.full_path else f"{package} {name}")
