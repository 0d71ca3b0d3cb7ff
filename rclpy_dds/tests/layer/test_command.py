"""Where the layer's `ros2` command goes further than ROS 2's, and what it says of what it cannot do."""

from __future__ import annotations

from pathlib import Path

import pytest
from contract.commands import run as _run
from contract.conftest import Graph
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64

from rclpy_dds.commands import main as command


def test_a_dump_of_a_group_called_like_a_parameter_is_a_parameters_file(graph: Graph, tmp_path: Path) -> None:
    node, values = graph.node("sim"), {"gain": 1.5, "gain.a": 2.5, "valve.lag.time": 3.5}
    node.declare_parameters("", list(values.items()))
    status, output, errors = _run(graph, "param", "dump", "/sim")
    assert status == 0, errors
    assert "    gain: 1.5\n    gain.a: 2.5\n" in output and "    valve:\n      lag:\n        time: 3.5\n" in output
    file = tmp_path / "dumped.yaml"
    file.write_text(output)
    other = graph.node("other", cli_args=["--ros-args", "-r", "__node:=sim", "--params-file", str(file)])
    other.declare_parameters("", [(name, 0.0) for name in values])
    assert {name: other.get_parameter(name).value for name in values} == values


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["run", "no_package", "x"], "Package 'no_package' not found"),
        (["topic", "pub", "/x", "no_msgs/msg/X", "{}"], "The passed message type is invalid"),
        (["topic", "pub", "-1", "/x", "std_msgs/msg/Float64", "{dada: 1}"], "no attribute 'dada'"),
        (["topic", "pub", "-1", "/x", "std_msgs/msg/Float64", "5"], "dictionary in YAML format"),
        (["topic", "echo", "/nothing"], "Could not determine the type"),
        (["bag", "info", "/nothing.mcap"], "does not exist"),
        (["launch", "no_package", "x.launch.yaml"], "not found"),
        (["action", "list"], "does not offer actions; install ROS 2"),
        (["daemon", "start"], "a command finds the nodes by itself"),
        (["topics"], "there is no command 'topics'; it has bag, doctor"),
        (["topic", "rate", "/x"], "does not offer 'rate'; it has bw, delay, echo, find, hz"),
        (["pkg", "list"], "`ros2 pkg executables` says the like"),
        (["pkg", "executables", "no_package"], "Package 'no_package' not found"),
        (["topic", "pub", "-1", "/x", "std_msgs/msg/Float64", "{data: 1, data: 2}"], "data is already in line 1"),
    ],
)
def test_what_cannot_be_done_is_one_line_and_a_status(arguments: list[str], expected: str) -> None:
    status, output, errors = _run(None, *arguments)
    assert status == 1 and expected in errors
    assert "Traceback" not in output + errors


@pytest.mark.parametrize(
    "text", ["launch: 5", "launch:\n- fly: {}", "launch:\n- node: {exec: x}", "{", "launch:\n- arg: {name: a}"]
)
def test_an_unusable_launch_file_is_one_line(tmp_path: Path, text: str) -> None:
    file = tmp_path / "bad.launch.yaml"
    file.write_text(text)
    status, _, errors = _run(None, "launch", str(file))
    assert status == 1 and str(file) in errors and len(errors.strip().splitlines()) == 1


def test_help_lists_commands_with_their_verbs() -> None:
    for arguments in ([], ["--help"]):
        status, output, _ = _run(None, *arguments)
        shown = " ".join(output.split())
        assert status == 0 and "topics: bw, delay, echo, find, hz, info, list, pub, type" in shown
        assert "run Run a package specific executable." in shown and "packages: executables" in shown
    status, output, _ = _run(None, "param")
    assert status == 0 and "delete Delete parameter." in " ".join(output.split())


def test_doctor_reports_settings_topics_and_what_does_not_match(graph: Graph) -> None:
    node = graph.node("speaker")
    node.create_publisher(Float64, "x", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    node.create_subscription(Float64, "x", lambda message: None, 10)
    status, output, errors = _run(graph, "doctor", "--report", "--spin-time", "2")
    assert status == 0, errors
    report = " ".join(output.split())
    assert "/x : 1 publishers, 1 subscribers" in report and "ROS_DOMAIN_ID : " in report
    assert "/x : speaker to speaker: " in report.partition("QOS COMPATIBILITY LIST")[2]


def test_ctrl_c_while_it_starts_ends_it_without_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(arguments: list[str]) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "_parser", interrupted)
    assert command.main(["topic", "list"]) == 130
