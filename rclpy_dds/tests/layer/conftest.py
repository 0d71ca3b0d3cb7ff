"""Tests of the layer alone: what stands behind its rclpy, and what it promises beyond ROS 2's."""

from __future__ import annotations

from pathlib import Path

import pytest
from contract.conftest import IS_LAYER, graph, program

__all__ = ["graph", "program"]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip this folder where a real rclpy is present."""
    for item in items:
        if not IS_LAYER and Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.skip(reason="of the layer alone; a real rclpy is present"))
