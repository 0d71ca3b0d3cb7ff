"""What holds for every test."""

from __future__ import annotations

import os
from typing import Any

import pytest

# Threads of linear algebra and of OpenMP wait by spinning: on small problems, beside other processes, they cost more
# time than they save. Set before NumPy loads; the processes that tests start inherit it.
for _library in ("OPENBLAS", "OMP"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

NODES = ("rclpy_dds/tests/", "tests/graph/")
"""Where tests start nodes."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Of several processes, one runs all tests of a file, which share what they make, and one all that start nodes,
    which would meet on DDS and wait for each other's processor."""
    from xdist.scheduler import LoadFileScheduling

    class Together(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = nodeid.partition("::")[0]
            return "nodes" if file.startswith(NODES) else file

    return Together(config, log)
