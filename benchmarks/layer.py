"""The nodes' rclpy against plain Cyclone DDS: the benchmarks of `rclpy_dds`, which run by themselves in its folder."""

from __future__ import annotations

import subprocess
import sys

from benchmarks.processes import ROOT
from benchmarks.row import Row, from_markdown
from eha_core.errors import EhaError

COMMAND = [sys.executable, str(ROOT / "rclpy_dds" / "benchmarks")]


def measure() -> list[Row]:
    """Run the layer's own benchmarks and return the rows of their table."""
    ended = subprocess.run(COMMAND, stdout=subprocess.PIPE, text=True, check=False)
    if ended.returncode:
        raise EhaError(f"rclpy_dds/benchmarks ended with {ended.returncode}; what it said stands above")
    return from_markdown(ended.stdout)
