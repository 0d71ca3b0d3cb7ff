"""Calls of the `ros2` command beside a test."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

from contract.conftest import Graph

ROS2 = shutil.which("ros2", path=os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", "")]))


class Command:
    """One call of `ros2`, running beside the test."""

    def __init__(self, *arguments: str, cwd: Path | None = None) -> None:
        self.process = subprocess.Popen(
            [str(ROS2), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd,
            start_new_session=True,
        )  # fmt: skip

    def interrupt(self) -> None:
        """Send what Ctrl-C sends: a signal to the command and to what it has started."""
        os.killpg(self.process.pid, signal.SIGINT)

    def result(self, timeout: float = 30.0) -> tuple[int, str, str]:
        """Return exit status, output and errors."""
        try:
            output, errors = self.process.communicate(timeout=timeout)
        finally:
            if self.process.poll() is None:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.communicate()
        return self.process.returncode, output, errors


def run(graph: Graph | None, *arguments: str) -> tuple[int, str, str]:
    """Run a command to its end while the test's nodes go on."""
    command = Command(*arguments)
    if graph is not None:
        assert graph.spin_until(lambda: command.process.poll() is not None, 30.0)
    return command.result()
