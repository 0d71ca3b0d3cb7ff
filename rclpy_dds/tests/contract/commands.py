"""Calls of the `ros2` command beside a test."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import rclpy

from contract.conftest import IS_LAYER, Graph

ROS2 = shutil.which("ros2", path=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")]))
needs_ros2 = pytest.mark.skipif(ROS2 is None, reason="no ros2 command")
# A real rclpy without a `ros2` of its own is looked at with the layer's: all but services work between the two.
_ACROSS = not IS_LAYER and ROS2 is not None and "rclpy_dds" in Path(ROS2).read_text(encoding="utf-8", errors="replace")
calls_services = pytest.mark.skipif(
    _ACROSS and rclpy.get_rmw_implementation_identifier() == "rmw_fastrtps_cpp",
    reason="calls a service between Cyclone DDS and Fast DDS, which do not understand each other's",
)


class Command:
    """One call of `ros2`, running beside the test within a `with`, which leaves nothing of it behind."""

    def __init__(self, *arguments: str, cwd: Path | None = None) -> None:
        self.process = subprocess.Popen(
            [str(ROS2), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd,
            start_new_session=True,
        )  # fmt: skip

    def __enter__(self) -> Command:
        return self

    def __exit__(self, *_: object) -> None:
        """End what a failed test left running; by asking, since a killed node stays in the graph for its lease."""
        assert self.process.stdout is not None
        if self.process.stdout.closed:  # its result was taken
            return
        with contextlib.suppress(ProcessLookupError):
            self.interrupt()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.result(10.0)

    def interrupt(self) -> None:
        """Send what Ctrl-C sends: a signal to the command and to what it has started."""
        os.killpg(self.process.pid, signal.SIGINT)

    def result(self, timeout: float = 30.0) -> tuple[int, str, str]:
        """Return exit status, output and errors."""
        try:
            output, errors = self.process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:  # the command, or what it has started and which holds its output open
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.communicate()
            raise
        return self.process.returncode, output, errors


def run(graph: Graph | None, *arguments: str) -> tuple[int, str, str]:
    """Run a command to its end while the test's nodes go on."""
    with Command(*arguments) as command:
        if graph is not None:
            assert graph.spin_until(lambda: command.process.poll() is not None, 30.0)
        return command.result()


def in_the_end(graph: Graph | None, text: str, *arguments: str) -> str:
    """Return a command's output once it holds a text: ROS 2's daemon and the layer first have to find the nodes."""
    status, output = 1, ""
    for _ in range(5):
        status, output, _ = run(graph, *arguments)
        if status == 0 and text in output:
            break
    assert status == 0 and text in output
    return output
