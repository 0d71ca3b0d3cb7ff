"""The `ros2` command's verbs about types and parameter files."""

from __future__ import annotations

from pathlib import Path

import yaml
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from contract.commands import calls_services, in_the_end, needs_ros2, run
from contract.conftest import Graph

pytestmark = needs_ros2


def test_types_are_told_by_name(graph: Graph) -> None:
    node = graph.node("sim")
    node.create_publisher(Float64, "volts", 10)
    node.create_service(SetBool, "switch", lambda request, response: response)
    assert in_the_end(graph, "", "topic", "type", "/volts") == "std_msgs/msg/Float64\n"
    assert in_the_end(graph, "", "service", "type", "/switch") == "std_srvs/srv/SetBool\n"
    assert run(graph, "topic", "type", "/nothing")[0] == 1


def test_interfaces_are_listed_and_shown() -> None:
    status, output, _ = run(None, "interface", "list")
    assert status == 0 and "std_msgs/msg/Float64" in {line.strip() for line in output.splitlines()}
    status, output, _ = run(None, "interface", "show", "std_srvs/srv/SetBool")
    shown = [line.split("#")[0].strip() for line in output.splitlines()]
    assert status == 0 and [line for line in shown if line] == ["bool data", "---", "bool success", "string message"]


@calls_services
def test_parameters_are_dumped_as_a_file_and_loaded_from_one(graph: Graph, tmp_path: Path) -> None:
    node = graph.node("sim", namespace="/rig")
    node.declare_parameters("", [("leakage", 1e-12), ("group.names", ["a", "b"]), ("count", 3)])
    dumped = yaml.safe_load(in_the_end(graph, "", "param", "dump", "/rig/sim"))["/rig/sim"]["ros__parameters"]
    assert (float(dumped["leakage"]), dumped["group"]["names"], dumped["count"]) == (1e-12, ["a", "b"], 3)
    file = tmp_path / "parameters.yaml"
    file.write_text("/rig/sim:\n  ros__parameters:\n    leakage: 0.25\n    group: {names: [c]}\n")
    status, output, _ = run(graph, "param", "load", "/rig/sim", str(file))
    assert status == 0 and "Set parameter leakage successful" in output
    assert node.get_parameter("leakage").value == 0.25
    assert list(node.get_parameter("group.names").value) == ["c"]
    assert node.get_parameter("count").value == 3
