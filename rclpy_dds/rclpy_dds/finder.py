"""Answers `import rclpy` and `import std_msgs.msg` where no real ROS 2 does.

The installed `rclpy_dds.pth` calls :func:`install` in every interpreter, so this module imports little.
"""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import importlib.util
import os
import sys
from collections.abc import Sequence
from types import ModuleType

from rclpy_dds.interfaces.folders import interface_folders

OVERLAY = os.path.join(os.path.dirname(os.path.abspath(__file__)), "overlay")
_STORE_SUFFIXES = ("_msgs", "_interfaces", "_srvs", "rmw_dds_common")


class Finder(importlib.abc.MetaPathFinder):
    """Gives way to whatever else can import a name; answers only what nothing else does."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the layer's spec for an overlay or interface package, or None."""
        package, _, rest = fullname.partition(".")
        if rest:
            module = sys.modules.get(package)
            if getattr(module, "__rclpy_dds__", False) and os.path.basename(path[0] if path else "") != "rclpy":
                from rclpy_dds.interfaces import packages

                return packages.submodule_spec(fullname)
            return None
        overlay = os.path.join(OVERLAY, package, "__init__.py")
        is_overlay = os.path.isfile(overlay)
        if not is_overlay and not package.endswith(_STORE_SUFFIXES) and not interface_folders(package):
            return None
        if self._found_elsewhere(package) or (package != "rclpy" and self._found_elsewhere("rclpy")):
            return None
        if is_overlay:
            return importlib.util.spec_from_file_location(
                package, overlay, submodule_search_locations=[os.path.dirname(overlay)]
            )
        from rclpy_dds.interfaces import packages

        return packages.package_spec(package)

    def _found_elsewhere(self, package: str) -> bool:
        """Tell whether another finder has a real module; a bare folder of that name is none."""
        for finder in sys.meta_path:
            find_spec = getattr(finder, "find_spec", None)
            if finder is self or find_spec is None:
                continue
            spec = find_spec(package, None)
            if spec is not None and spec.origin is not None:
                return True
        return False


def real_rclpy_present() -> bool:
    """Tell whether a ROS 2 installation's own rclpy is importable in this interpreter."""
    finder = next((f for f in sys.meta_path if isinstance(f, Finder)), None) or Finder()
    return finder._found_elsewhere("rclpy")


def install() -> None:
    """Register the finder. It stands first only so that a plain folder named like a package does not hide one."""
    if not any(isinstance(finder, Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, Finder())
