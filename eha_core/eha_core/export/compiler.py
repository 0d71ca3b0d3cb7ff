"""The C compiler that PyPI's `ziglang` brings along, for this machine and for others."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from eha_core.errors import EhaError

LINUX, WINDOWS = "x86_64-linux-gnu.2.17", "x86_64-windows-gnu"
"""Targets of an FMU: the oldest C library that today's Linux distributions exceed, and Windows from 8.1 on."""

MACHINES = ("x86_64", "aarch64", "riscv64")
"""Processors that the kernel's text fits: little-endian with 64-bit addresses."""

# no contraction into fused operations, which round otherwise than the plant does
FLAGS = ("-O2", "-w", "-fPIC", "-fvisibility=hidden", "-ffp-contract=off", "-g0")


def require_compiler() -> None:
    """Raise EhaError where ziglang is not installed."""
    if find_spec("ziglang") is None:
        raise EhaError("the compiler is missing; install it: pip install ziglang")


def require_target(target: str) -> None:
    """Raise EhaError for a target whose processor the kernel is not made for."""
    if target.partition("-")[0] not in MACHINES:
        raise EhaError(
            f"--target {target}: the kernel needs one of {', '.join(MACHINES)}; give for example x86_64-linux-gnu"
        )


def compile_c(folder: Path, target: str, words: Sequence[str]) -> None:
    """Run the compiler in a folder, for a target as zig names it; EhaError with its first complaint where it fails."""
    _run(folder, target, ["cc", "-target", target, *FLAGS, *words])


def archive(folder: Path, target: str, name: str, objects: Sequence[str]) -> None:
    """Put objects in a folder into a static library."""
    _run(folder, target, ["ar", "rcs", name, *objects])


def _run(folder: Path, target: str, words: Sequence[str]) -> None:
    require_compiler()
    done = subprocess.run(
        [sys.executable, "-m", "ziglang", *words], cwd=folder, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        complaints = [line for line in done.stderr.splitlines() if "error" in line] or [done.stderr]
        raise EhaError(f"{target}: the compiler refused: {complaints[0]}")
