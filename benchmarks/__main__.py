"""`make bench`, or `python -m benchmarks` in a checkout: speed as ratios to named peers, measured in one run."""

from __future__ import annotations

import argparse
import os
import platform
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from benchmarks.row import as_markdown
from eha_core.errors import EhaError

BENCHMARKS = ("plant_step", "lockstep", "integrators", "windows", "reading", "diagnosis", "layer", "node")
ON_REQUEST = ("hour", "nodes", "structure")
"""Those that take many minutes, a core that nothing else uses, or a peer that `make env` does not install: they are
measured where they are named."""


def parser() -> argparse.ArgumentParser:
    """The command's arguments."""
    made = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Measures the plant's step, the integrator, a fit's normal equations, the reading of recordings, a "
        "diagnosis, the nodes' rclpy and the simulator node against their peers, in one run.",
    )
    made.add_argument(
        "names",
        nargs="*",
        metavar="BENCHMARK",
        help=f"which of {', '.join(BENCHMARKS)} (default: all of these), {', '.join(ON_REQUEST)}",
    )
    made.add_argument(
        "--seconds",
        type=float,
        default=60.0,
        metavar="S",
        help="length of the simulator node's run; 0 leaves it out (default: %(default)s)",
    )
    return made


def main(words: Sequence[str] | None = None) -> int:
    """Run the benchmarks and print their table."""
    arguments = parser().parse_args(words)
    known = (*BENCHMARKS, *ON_REQUEST)
    unknown = [name for name in arguments.names if name not in known]
    if arguments.seconds and arguments.seconds < 30.0:
        return _refuse(f"--seconds {arguments.seconds:g} is too short for reports of 10 s each; give 30 or more, or 0")
    if unknown:
        return _refuse(f"there is no benchmark {unknown[0]!r}; give some of {', '.join(known)}, or none for all")
    machine = f"{_processor()}, {os.cpu_count()} CPUs, load {os.getloadavg()[0]:.1f}"
    print(f"{machine}, Python {platform.python_version()}", flush=True)
    rows = []
    for name in arguments.names or BENCHMARKS:
        options = (arguments.seconds,) if name == "node" else ()
        if options != (0.0,):
            print(f"measuring {name} ...", file=sys.stderr, flush=True)
            try:
                rows += import_module(f"benchmarks.{name}").measure(*options)
            except EhaError as error:
                return _refuse(f"{name}: {error}")
    print(as_markdown(rows))
    return 0


def _refuse(message: str) -> int:
    print(f"benchmarks: {message}", file=sys.stderr)
    return 2


def _processor() -> str:
    """Return the processor's name as the kernel tells it, or the machine's kind."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


if __name__ == "__main__":
    sys.exit(main())
