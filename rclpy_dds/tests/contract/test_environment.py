"""Environment variables: which domain, how far, and what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest

from contract.conftest import Graph, Program

Start = Callable[..., Program]

NODE = """
import rclpy
from rclpy.executors import ExternalShutdownException
rclpy.init()
node = rclpy.create_node("elsewhere")
print("ready in", rclpy.get_default_context().get_domain_id())
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
"""
OTHER_DOMAIN = str(int(os.environ["ROS_DOMAIN_ID"]) - 1)


def _is_seen(graph: Graph, timeout: float) -> bool:
    return graph.spin_until(lambda: "elsewhere" in graph.nodes[0].get_node_names(), timeout)


def test_a_node_beside_this_one_is_seen(graph: Graph, program: Start) -> None:
    graph.node("observer")
    program(NODE).wait_for("ready")
    assert _is_seen(graph, 5.0)


@pytest.mark.parametrize(
    ("name", "value"),
    [("ROS_DOMAIN_ID", OTHER_DOMAIN), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")],
    ids=["another domain", "no discovery"],
)
def test_another_domain_and_no_discovery_hide_a_node(
    graph: Graph, program: Start, monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    graph.node("observer")
    monkeypatch.setenv(name, value)
    line = program(NODE).wait_for("ready")
    assert line.split()[-1] == os.environ["ROS_DOMAIN_ID"]
    assert not _is_seen(graph, 1.5)


def test_localhost_only_still_finds_what_is_on_this_machine(
    graph: Graph, program: Start, monkeypatch: pytest.MonkeyPatch
) -> None:
    graph.node("observer")
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    program(NODE).wait_for("ready")
    assert _is_seen(graph, 5.0)
