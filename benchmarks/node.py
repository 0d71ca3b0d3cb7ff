"""The simulator node at 1 kHz with four subscribers, each a process of its own, beside a bare sleep loop."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.processes import ROOT, start, use_own_domain
from benchmarks.row import Row, skipped
from benchmarks.sleep_loop import PERCENTILES

RATE = 1000.0
SUBSCRIBERS = 4
WINDOW = 10.0  # s; the node reports the lateness of this long a stretch, the longest it offers
START_LIMIT = 60.0
_WHAT = f"sim node at 1 kHz, {SUBSCRIBERS} subscribers"


@dataclass(frozen=True)
class Run:
    """What the node reported and used, what each subscriber counted, and the bare loop's lateness; times in s.

    Lateness is by PERCENTILES, each in its worst window.
    """

    lateness: tuple[float, ...]
    lost_time: float
    received: tuple[int, ...]
    missing: tuple[int, ...]
    bare_lateness: tuple[float, ...]
    cpu_share: float


def measure(seconds: float) -> list[Row]:
    """Run node, subscribers and bare loop together for so long [s]."""
    try:
        import rclpy
    except ImportError:
        return [skipped(_WHAT, "no step lost", "there is neither ROS 2 nor rclpy_dds")]
    use_own_domain()
    options = ["-p", f"publish_rate:={RATE}", "-p", f"diagnostics_rate:={1.0 / WINDOW}"]
    simulator = subprocess.Popen([sys.executable, "-m", "eha_sim_node.sim", "--ros-args", *options], cwd=ROOT)
    started: list[subprocess.Popen[str]] = []
    try:
        rclpy.init()
        run = _observe(rclpy, simulator.pid, started, seconds)
    finally:
        rclpy.try_shutdown()
        for process in started:
            process.kill()
            process.wait()
        simulator.send_signal(signal.SIGINT)
        simulator.wait()
    return _rows(run, seconds)


def _observe(rclpy: Any, simulator: int, started: list[subprocess.Popen[str]], seconds: float) -> Run:
    """Start what runs beside the simulator, adding it to `started`, and gather what all of them say."""
    from diagnostic_msgs.msg import DiagnosticArray

    node = rclpy.create_node("benchmark")
    reports: list[dict[str, str]] = []

    def on_report(message: DiagnosticArray) -> None:
        reports.extend({pair.key: pair.value for pair in status.values} for status in message.status)

    node.create_subscription(DiagnosticArray, "/diagnostics", on_report, 10)
    deadline = time.monotonic() + START_LIMIT
    while not reports and time.monotonic() < deadline:
        rclpy.spin_once(node, timeout_sec=0.5)
    started += [start("subscriber", seconds, round(1e9 / RATE)) for _ in range(SUBSCRIBERS)]
    started.append(start("sleep_loop", RATE, seconds, WINDOW))
    reports.clear()
    cpu, begun = cpu_seconds(simulator), time.monotonic()
    while time.monotonic() - begun < seconds:
        rclpy.spin_once(node, timeout_sec=0.5)
    share = (cpu_seconds(simulator) - cpu) / (time.monotonic() - begun)
    *counts, bare = [process.communicate(timeout=seconds + START_LIMIT)[0].split() for process in started]
    return Run(
        # The first report still covers the start of the subscribers.
        lateness=tuple(max(float(report[f"lateness_{name}"]) for report in reports[1:]) for name in PERCENTILES),
        lost_time=float(reports[-1]["lost_time"]),
        received=tuple(int(received) for received, _ in counts),
        missing=tuple(int(missing) for _, missing in counts),
        bare_lateness=tuple(float(late) for late in bare),
        cpu_share=share,
    )


def cpu_seconds(process: int) -> float:
    """Return the CPU time [s] that a process has used, user and system."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def milliseconds(lateness: tuple[float, ...]) -> str:
    return ", ".join(f"{late * 1e3:.3f}" for late in lateness) + " ms"


def _rows(run: Run, seconds: float) -> list[Row]:
    complete = run.lost_time == 0.0 and not any(run.missing)
    return [
        Row(
            f"{_WHAT}, {seconds:g} s: steps",
            f"{run.lost_time:g} s lost; messages received: {', '.join(map(str, run.received))}",
            "the stamps' own count",
            f"{sum(run.missing)} missing",
            "none lost",
            complete,
        ),
        Row(
            f"{_WHAT}: lateness p50, p99, p99.9, and lost time",
            f"{milliseconds(run.lateness)}; {run.lost_time:g} s lost",
            f"bare sleep loop beside it: {milliseconds(run.bare_lateness)}",
            f"p99 {run.lateness[1] / run.bare_lateness[1]:.2f} x",
            "stated",
            True,
        ),
        Row(f"{_WHAT}: CPU", f"{run.cpu_share * 100:.0f} % of one core", "-", "-", "stated", True),
    ]
