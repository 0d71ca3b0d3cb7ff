"""Sixteen simulator nodes at 1 kHz on one core; then as many bare sleep loops on it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from benchmarks.node import RATE, START_LIMIT, WINDOW, cpu_seconds, milliseconds
from benchmarks.processes import ROOT, start, use_own_domain
from benchmarks.row import Row, skipped
from benchmarks.sleep_loop import PERCENTILES

NODES = 16
SECONDS = 30.0
_WHAT = f"{NODES} sim nodes at 1 kHz on one core, {SECONDS:g} s"

Reports = dict[str, list[dict[str, str]]]
"""What each node said on /diagnostics, by its name."""


def measure() -> list[Row]:
    """Run the nodes, and then the bare loops."""
    try:
        import rclpy
    except ImportError:
        return [skipped(_WHAT, "none lost", "there is neither ROS 2 nor rclpy_dds")]
    use_own_domain()
    core = min(os.sched_getaffinity(0))
    nodes = [_simulator(number, core) for number in range(NODES)]
    try:
        rclpy.init()
        reports, used = _observe(rclpy, [node.pid for node in nodes])
    finally:
        rclpy.try_shutdown()
        for node in nodes:
            node.send_signal(signal.SIGINT)
        for node in nodes:
            node.wait()
    loops = [start("sleep_loop", RATE, SECONDS, WINDOW) for _ in range(NODES)]
    for loop in loops:
        os.sched_setaffinity(loop.pid, {core})
    bare = [[float(late) for late in loop.communicate()[0].split()] for loop in loops]
    return _rows(reports, used, bare)


def _simulator(number: int, core: int) -> subprocess.Popen[bytes]:
    options = ["-r", f"__ns:=/rig{number}", "-p", f"publish_rate:={RATE}", "-p", f"diagnostics_rate:={1.0 / WINDOW}"]
    command = [sys.executable, "-m", "eha_sim_node.sim", "--ros-args", "--log-level", "error", *options]
    node = subprocess.Popen(command, cwd=ROOT)
    os.sched_setaffinity(node.pid, {core})  # before it has threads, which take it over
    return node


def _observe(rclpy: Any, processes: list[int]) -> tuple[Reports, float]:
    """What the nodes report once all of them are there, and the share of a core that they use."""
    from diagnostic_msgs.msg import DiagnosticArray

    node = rclpy.create_node("benchmark")
    reports: Reports = {}

    def on_report(message: DiagnosticArray) -> None:
        for status in message.status:
            reports.setdefault(status.name, []).append({pair.key: pair.value for pair in status.values})

    node.create_subscription(DiagnosticArray, "/diagnostics", on_report, 100)
    _spin(rclpy, node, lambda: len(reports) == NODES, START_LIMIT)
    _spin(rclpy, node, lambda: False, 2.0 * WINDOW)  # a report and more that still tell of the start
    for published in reports.values():
        del published[:-1]
    before, begun = sum(map(cpu_seconds, processes)), time.monotonic()
    _spin(rclpy, node, lambda: False, SECONDS + WINDOW)
    return reports, (sum(map(cpu_seconds, processes)) - before) / (time.monotonic() - begun)


def _spin(rclpy: Any, node: Any, done: Callable[[], bool], limit: float) -> None:
    deadline = time.monotonic() + limit
    while not done() and time.monotonic() < deadline:
        rclpy.spin_once(node, timeout_sec=0.5)


def _rows(reports: Reports, used: float, bare: list[list[float]]) -> list[Row]:
    lost = [float(published[-1]["lost_time"]) - float(published[0]["lost_time"]) for published in reports.values()]
    late = tuple(
        max(float(report[f"lateness_{name}"]) for published in reports.values() for report in published[1:])
        for name in PERCENTILES
    )
    loops = tuple(max(several) for several in zip(*bare, strict=True))
    return [
        Row(
            f"{_WHAT}: lateness p50, p99, p99.9 of the worst, and lost time of all",
            f"{milliseconds(late)}; {sum(lost):g} s lost by {sum(share > 0.0 for share in lost)} of {len(reports)}",
            f"{NODES} bare sleep loops on it: {milliseconds(loops)}",
            f"p99 {late[1] / loops[1]:.2f} x",
            "none lost",
            len(reports) == NODES and not any(lost),
        ),
        Row(f"{_WHAT}: CPU", f"{used * 100:.0f} % of the core", "-", "-", "stated", True),
    ]
