"""Where packages and their definitions are: the layer's own share folder, and the prefixes of installations."""

from __future__ import annotations

import os
import sys

SHARE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def prefixes() -> list[str]:
    """Return the installation prefixes searched for packages: AMENT_PREFIX_PATH, then this interpreter's own."""
    found = [path for path in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if path]
    found.append(sys.prefix)
    return list(dict.fromkeys(found))


def interface_folders(package: str) -> list[str]:
    """Return the share folders of `package` that hold .msg or .srv files, the nearest first."""
    folders = (os.path.join(prefix, "share", package) for prefix in (*prefixes(), SHARE))
    return [f for f in folders if os.path.isdir(os.path.join(f, "msg")) or os.path.isdir(os.path.join(f, "srv"))]
