"""`python benchmarks` in the layer's folder: its speed as ratios to plain Cyclone DDS, measured in one run.

The folder is no package, so that it hides no other of its name; its modules are found beside this one.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Sequence

from layer_rows import as_markdown, measure


def main(words: Sequence[str] | None = None) -> int:
    """Run the benchmarks and print their table."""
    argparse.ArgumentParser(
        prog="python benchmarks",
        description="Measures the rclpy that is there against plain Cyclone DDS for Python, and what its "
        "executor costs, in one run of about two minutes.",
    ).parse_args(words)
    print(f"{os.cpu_count()} CPUs, load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}", flush=True)
    try:
        rows = measure()
    except RuntimeError as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return 1
    print(as_markdown(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
