"""The programs that packages install, for `ros2 run` and for launch files."""

from __future__ import annotations

import os

from ament_index_python.packages import get_package_prefix

from rclpy_dds.errors import CommandError


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
