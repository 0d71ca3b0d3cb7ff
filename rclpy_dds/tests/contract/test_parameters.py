"""Parameters: declaring, setting, refusing, and the services behind them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

from contract.conftest import Graph


def _range(low: float, high: float) -> ParameterDescriptor:
    return ParameterDescriptor(
        description="a gain [-]", floating_point_range=[FloatingPointRange(from_value=low, to_value=high)]
    )


def _set(node: Node, name: str, value: Any) -> SetParametersResult:
    return node.set_parameters([Parameter(name, value=value)])[0]


@pytest.mark.parametrize("value", [True, -3, 2.5, "text", [True, False], [1, 2], [0.5, 1.5], ["a", "b"]])
def test_every_type_is_kept(graph: Graph, value: Any) -> None:
    node = graph.node("owner")
    node.declare_parameter("p", value)
    found = node.get_parameter("p").value
    assert list(found) == value if isinstance(value, list) else found == value


def test_declaring_needs_a_new_name_and_reading_a_declared_one(graph: Graph) -> None:
    node = graph.node("owner")
    node.declare_parameter("p", 1)
    with pytest.raises(ParameterAlreadyDeclaredException):
        node.declare_parameter("p", 2)
    with pytest.raises(ParameterNotDeclaredException):
        node.get_parameter("q")
    with pytest.raises(ParameterNotDeclaredException):
        node.set_parameters([Parameter("q", value=1)])


def test_a_typed_parameter_without_a_value_is_uninitialised(graph: Graph) -> None:
    node = graph.node("owner")
    node.declare_parameter("p", Parameter.Type.DOUBLE)
    with pytest.raises(ParameterUninitializedException):
        node.get_parameter("p")
    assert _set(node, "p", 1.5).successful
    assert node.get_parameter("p").value == 1.5


@pytest.mark.parametrize(
    ("value", "accepted"),
    [(0.0, True), (2.0, True), (1.0, True), (2.1, False), (-0.1, False), (math.nan, False), (1, False), ("1.0", False)],
)
def test_ranges_and_types_are_enforced(graph: Graph, value: Any, accepted: bool) -> None:
    node = graph.node("owner")
    node.declare_parameter("gain", 0.5, _range(0.0, 2.0))
    result = _set(node, "gain", value)
    assert result.successful is accepted
    assert bool(result.reason) is not accepted
    assert node.get_parameter("gain").value == (value if accepted else 0.5)


def test_integer_steps_are_enforced(graph: Graph) -> None:
    node = graph.node("owner")
    steps = ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=3)])
    node.declare_parameter("count", 3, steps)
    assert [_set(node, "count", value).successful for value in (6, 7, 10, 11)] == [True, False, True, False]


def test_a_declared_value_must_fit_its_own_range(graph: Graph) -> None:
    with pytest.raises(InvalidParameterValueException):
        graph.node("owner").declare_parameter("gain", 5.0, _range(0.0, 2.0))


def test_a_read_only_parameter_stays(graph: Graph) -> None:
    node = graph.node("owner")
    node.declare_parameter("serial", "A1", ParameterDescriptor(read_only=True))
    result = _set(node, "serial", "B2")
    assert not result.successful and "read-only" in result.reason
    assert node.get_parameter("serial").value == "A1"


def test_callbacks_change_refuse_and_hear_of_values(graph: Graph) -> None:
    node, heard = graph.node("owner"), []
    node.declare_parameters("", [("a", 1.0), ("b", 2.0)])

    def accept(parameters: list[Parameter]) -> SetParametersResult:
        total = sum(parameter.value for parameter in parameters)
        return SetParametersResult(successful=total < 10.0, reason="" if total < 10.0 else "sum too large")

    node.add_pre_set_parameters_callback(lambda ps: [Parameter(p.name, value=p.value * 2.0) for p in ps])
    node.add_on_set_parameters_callback(accept)
    node.add_post_set_parameters_callback(lambda ps: heard.extend((p.name, p.value) for p in ps))
    assert node.set_parameters_atomically([Parameter("a", value=2.0), Parameter("b", value=1.0)]).successful
    refused = node.set_parameters_atomically([Parameter("a", value=3.0), Parameter("b", value=3.0)])
    assert not refused.successful and refused.reason == "sum too large"
    assert heard == [("a", 4.0), ("b", 2.0)]
    assert (node.get_parameter("a").value, node.get_parameter("b").value) == (4.0, 2.0)


def test_undeclared_parameters_where_they_are_allowed(graph: Graph) -> None:
    node = graph.node("owner", allow_undeclared_parameters=True)
    assert node.get_parameter("p").type_ == Parameter.Type.NOT_SET
    assert _set(node, "p", 1).successful and _set(node, "p", "text").successful
    assert node.get_parameter("p").value == "text"


def test_overrides_from_arguments_and_a_file(graph: Graph, tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n    a: 1.5\n    group: {inner: [1, 2]}\n"
        "owner:\n  ros__parameters:\n    b: 1e-10\nother:\n  ros__parameters:\n    a: 9.0\n"
    )
    arguments = ["--ros-args", "--params-file", str(file), "-p", "c:=seven", "-p", "other:a:=3.0"]
    node = graph.node("owner", cli_args=arguments)
    node.declare_parameters("", [("a", 0.0), ("b", 0.0), ("c", ""), ("group.inner", [0])])
    assert node.get_parameter("a").value == 1.5
    assert node.get_parameter("b").value == 1e-10
    assert node.get_parameter("c").value == "seven"
    assert list(node.get_parameters_by_prefix("group")["inner"].value) == [1, 2]


def test_an_override_of_another_type_is_refused(graph: Graph) -> None:
    node = graph.node("owner", cli_args=["--ros-args", "-p", "gain:=text"])
    with pytest.raises(InvalidParameterTypeException):
        node.declare_parameter("gain", 1.0)


def _call(graph: Graph, srv_type: Any, name: str, request: Any) -> Any:
    client = graph.nodes[-1].create_client(srv_type, name)
    assert client.wait_for_service(5.0)
    future = client.call_async(request)
    assert graph.spin_until(future.done)
    return future.result()


def test_the_six_services(graph: Graph) -> None:
    node = graph.node("owner", namespace="/rig")
    node.declare_parameter("gain", 0.5, _range(0.0, 2.0))
    node.declare_parameter("valve.deadband", 0.0)
    graph.node("user")
    names = list(_call(graph, ListParameters, "/rig/owner/list_parameters", ListParameters.Request()).result.names)
    assert {"gain", "valve.deadband", "use_sim_time"} <= set(names)
    described = _call(
        graph, DescribeParameters, "/rig/owner/describe_parameters", DescribeParameters.Request(names=["gain"])
    )
    assert described.descriptors[0].description == "a gain [-]"
    assert described.descriptors[0].floating_point_range[0].to_value == 2.0
    parameters = [Parameter("gain", value=v).to_parameter_msg() for v in (1.0, 5.0)] + [
        Parameter("nothing", value=1).to_parameter_msg()
    ]
    results = _call(
        graph, SetParameters, "/rig/owner/set_parameters", SetParameters.Request(parameters=parameters)
    ).results
    assert [result.successful for result in results] == [True, False, False]
    assert all(result.reason for result in results[1:])
    atomic = SetParametersAtomically.Request(
        parameters=[
            Parameter("valve.deadband", value=1.0).to_parameter_msg(),
            Parameter("gain", value=9.0).to_parameter_msg(),
        ]
    )
    assert not _call(graph, SetParametersAtomically, "/rig/owner/set_parameters_atomically", atomic).result.successful
    got = _call(
        graph, GetParameters, "/rig/owner/get_parameters", GetParameters.Request(names=["gain", "valve.deadband"])
    )
    assert [value.double_value for value in got.values] == [1.0, 0.0]
    missing = _call(graph, GetParameters, "/rig/owner/get_parameters", GetParameters.Request(names=["gain", "nothing"]))
    assert list(missing.values) == []


def test_a_change_is_announced(graph: Graph) -> None:
    node, events = graph.node("owner"), []
    node.create_subscription(ParameterEvent, "/parameter_events", events.append, 10)
    node.declare_parameter("gain", 1.0)
    _set(node, "gain", 2.0)
    assert graph.spin_until(lambda: any(event.changed_parameters for event in events))
    changed = next(event for event in events if event.changed_parameters)
    assert changed.node == "/owner"
    assert changed.changed_parameters[0].value.double_value == 2.0


def test_a_type_may_be_left_open_and_a_parameter_forgotten(graph: Graph) -> None:
    node = graph.node("owner")
    node.declare_parameter("p", 1, ParameterDescriptor(dynamic_typing=True))
    assert _set(node, "p", "text").successful
    assert node.get_parameter("p").value == "text"
    node.undeclare_parameter("p")
    assert not node.has_parameter("p")
    node.declare_parameter("fixed", 1, ParameterDescriptor(read_only=True))
    with pytest.raises(ParameterImmutableException):
        node.undeclare_parameter("fixed")


def test_overrides_declare_where_that_is_asked_for(graph: Graph) -> None:
    given = [Parameter("a", value=1.5), Parameter("group.b", value="x")]
    node = graph.node("owner", parameter_overrides=given, automatically_declare_parameters_from_overrides=True)
    assert node.get_parameter("a").value == 1.5
    assert {name: found.value for name, found in node.get_parameters_by_prefix("group").items()} == {"b": "x"}
    assert node.get_parameter_or("c", Parameter("c", value=7)).value == 7
