"""`eha bench`: speed as ratios to named peers, measured in one run."""

from __future__ import annotations

import argparse
import os
import platform
import sys
from importlib import import_module
from pathlib import Path

from eha_core.errors import EhaError

_CHECKOUT = Path(__file__).resolve().parents[3]
_BENCHMARKS = ("plant_step", "integrators", "layer", "node")


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the command line."""
    parser = subparsers.add_parser(
        "bench",
        help="measure speed against named peers",
        description="Measures the plant's step, the integrator, the nodes' rclpy and the simulator node against their "
        "peers, in one run.",
    )
    parser.add_argument(
        "names", nargs="*", metavar="BENCHMARK", help=f"which of {', '.join(_BENCHMARKS)} (default: all of them)"
    )
    parser.add_argument(
        "--seconds",
        type=float,
        default=60.0,
        metavar="S",
        help="length of the simulator node's run; 0 leaves it out (default: %(default)s)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the benchmarks and print their table."""
    if not (_CHECKOUT / "benchmarks" / "row.py").is_file():
        raise EhaError("the benchmarks are not installed with the package; run this in a checkout of the project")
    if arguments.seconds and arguments.seconds < 30.0:
        raise EhaError(f"--seconds {arguments.seconds:g} is too short for reports of 10 s each; give 30 or more, or 0")
    unknown = [name for name in arguments.names if name not in _BENCHMARKS]
    if unknown:
        raise EhaError(f"there is no benchmark {unknown[0]!r}; give some of {', '.join(_BENCHMARKS)}, or none for all")
    sys.path.insert(0, str(_CHECKOUT))
    machine = f"{_processor()}, {os.cpu_count()} CPUs, load {os.getloadavg()[0]:.1f}"
    print(f"{machine}, Python {platform.python_version()}", flush=True)
    rows = []
    for name in arguments.names or _BENCHMARKS:
        options = (arguments.seconds,) if name == "node" else ()
        if options != (0.0,):
            print(f"measuring {name} ...", file=sys.stderr, flush=True)
            rows += import_module(f"benchmarks.{name}").measure(*options)
    print(import_module("benchmarks.row").as_markdown(rows))
    return 0


def _processor() -> str:
    """Return the processor's name as the kernel tells it, or the machine's kind."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
