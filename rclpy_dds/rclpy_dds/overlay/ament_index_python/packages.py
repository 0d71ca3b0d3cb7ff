"""Packages by name: a package is a folder share/<name> below an installation prefix."""

from __future__ import annotations

import os
from pathlib import Path

from rclpy_dds.interfaces.folders import prefixes


class PackageNotFoundError(KeyError):
    """Raised when no prefix has a package of that name."""

    def __str__(self) -> str:
        return f"package '{self.args[0]}' not found, searching: [{', '.join(prefixes())}]"


def get_packages_with_prefixes() -> dict[str, str]:
    """Return every package and its prefix; the first prefix that has it wins."""
    found: dict[str, str] = {}
    for prefix in prefixes():
        index = os.path.join(prefix, "share", "ament_index", "resource_index", "packages")
        if os.path.isdir(index):
            for name in sorted(os.listdir(index)):
                found.setdefault(name, prefix)
    return found


def get_package_prefix(package_name: str) -> str:
    """Return the prefix a package is installed in.

    Raises:
        PackageNotFoundError: nobody has it.
        ValueError: the name is empty.
    """
    if not package_name:
        raise ValueError("package name must not be empty")
    for prefix in prefixes():
        share = os.path.join(prefix, "share")
        marker = os.path.join(share, "ament_index", "resource_index", "packages", package_name)
        if os.path.isfile(marker) or os.path.isfile(os.path.join(share, package_name, "package.xml")):
            return prefix
    raise PackageNotFoundError(package_name)


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return the share folder of a package.

    Raises:
        PackageNotFoundError: nobody has it.
    """
    return os.path.join(get_package_prefix(package_name), "share", package_name)


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return the share folder of a package as a Path.

    Raises:
        PackageNotFoundError: nobody has it.
    """
    return Path(get_package_share_directory(package_name, print_warning))
