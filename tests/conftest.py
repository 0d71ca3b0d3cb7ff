"""What holds for every test."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

# Threads of linear algebra and of OpenMP wait by spinning: on small problems, beside other processes, they cost more
# time than they save. Set before NumPy loads; the processes that tests start inherit it.
for _library in ("OPENBLAS", "OMP"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

ROOT = Path(__file__).parents[1]
NODES = (ROOT / "rclpy_dds" / "tests", ROOT / "tests" / "graph")
"""Where tests start nodes."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Say which tests stay in one process where there are several: those of a file, which share what they make, and
    all that start nodes, which would meet on DDS and wait for each other's processor."""
    if not config.pluginmanager.hasplugin("xdist"):
        return
    for item in items:
        nodes = any(folder in item.path.parents for folder in NODES)
        item.add_marker(pytest.mark.xdist_group("nodes" if nodes else str(item.path.relative_to(ROOT))))
