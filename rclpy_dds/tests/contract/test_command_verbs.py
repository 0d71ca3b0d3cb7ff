"""Verbs of `ros2` about what a topic carries, what is of a type, and what a package can run."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from rcl_interfaces.msg import ParameterDescriptor
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from contract.commands import Command, calls_services, in_the_end, needs_ros2
from contract.commands import run as _run
from contract.conftest import Graph

pytestmark = needs_ros2


def watched(graph: Graph, publisher: object, publish: Callable[[], None], *arguments: str) -> str:
    """What a verb prints of a topic that is published a hundred times a second."""
    timer = graph.nodes[0].create_timer(0.01, publish)
    with Command(*arguments) as command:
        assert graph.spin_until(lambda: publisher.get_subscription_count() == 1, 20.0)  # type: ignore[attr-defined]
        end = time.monotonic() + 3.5  # it tells once a second
        graph.spin_until(lambda: time.monotonic() > end)
        command.interrupt()
        output = command.result()[1]
    timer.cancel()
    return output


def test_bw_tells_bytes_and_sizes(graph: Graph) -> None:
    publisher = graph.node("speaker").create_publisher(Float64, "x", 10)
    output = watched(graph, publisher, lambda: publisher.publish(Float64()), "topic", "bw", "/x")
    sizes = "mean: 12 B min: 12 B max: 12 B"  # 8 bytes, and CDR's head of 4
    assert re.search(rf"^\d+(\.\d+)? K?B/s from \d+ messages\n\tMessage size {sizes}\n", output, re.MULTILINE)


def test_delay_tells_the_age_of_the_stamps(graph: Graph) -> None:
    node = graph.node("speaker")
    publisher = node.create_publisher(JointState, "x", 10)

    def publish() -> None:
        message = JointState()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns() - 5 * 10**9, 10**9)
        publisher.publish(message)

    output = watched(graph, publisher, publish, "topic", "delay", "/x")
    assert 5.0 <= float(output.split("average delay: ")[1].split()[0]) < 6.0
    assert re.search(r"\tmin: \d\.\d{3}s max: \d\.\d{3}s std dev: \d\.\d{5}s window: \d+\n", output)


def test_find_lists_what_is_of_a_type(graph: Graph) -> None:
    node = graph.node("sim", namespace="/rig")
    node.create_publisher(Float64, "volts", 10)
    node.create_publisher(JointState, "joints", 10)
    node.create_service(SetBool, "switch", lambda request, response: response)
    assert in_the_end(graph, "/rig/volts", "topic", "find", "std_msgs/msg/Float64") == "/rig/volts\n"
    assert in_the_end(graph, "1", "topic", "find", "-c", "sensor_msgs/msg/JointState") == "1\n"
    assert in_the_end(graph, "/rig/switch", "service", "find", "std_srvs/srv/SetBool") == "/rig/switch\n"


@calls_services
def test_delete_undeclares_a_parameter_or_says_why_not(graph: Graph) -> None:
    node = graph.node("sim")
    node.declare_parameter("spare", 1, ParameterDescriptor(dynamic_typing=True))
    node.declare_parameter("gain", 1.0)
    done = "Deleted parameter successfully\n"
    assert in_the_end(graph, done, "param", "delete", "/sim", "spare") == done
    assert not node.has_parameter("spare")
    status, _, errors = _run(graph, "param", "delete", "/sim", "gain")
    assert errors.startswith("Deleting parameter failed") and status in (0, 1)  # here 1, as for `set`
    assert node.has_parameter("gain")


def test_executables_are_those_that_run_starts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "lib" / "some_package" / "node"
    index = tmp_path / "share" / "ament_index" / "resource_index" / "packages"
    for folder in (program.parent, index):
        folder.mkdir(parents=True)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    (index / "some_package").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path), prepend=":")
    assert _run(None, "pkg", "executables", "some_package")[:2] == (0, "some_package node\n")
    assert _run(None, "pkg", "executables", "--full-path", "some_package")[:2] == (0, f"{program}\n")
    assert "some_package node" in _run(None, "pkg", "executables")[1].splitlines()
