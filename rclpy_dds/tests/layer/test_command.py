"""Where the layer's `ros2` command goes further than ROS 2's, and what it says of what it cannot do."""

from __future__ import annotations

from pathlib import Path

import pytest
from contract.commands import run as _run
from contract.conftest import Graph

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
        (["action", "list"], "does not offer actions"),
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


def test_ctrl_c_while_it_starts_ends_it_without_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(arguments: list[str]) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "_parser", interrupted)
    assert command.main(["topic", "list"]) == 130
