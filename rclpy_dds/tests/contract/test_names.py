"""Names: validation, expansion, namespaces, remapping and --ros-args."""

from __future__ import annotations

import pytest
import rclpy
from rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
    NotInitializedException,
)
from rclpy.logging import LoggingSeverity
from rclpy.utilities import remove_ros_args
from std_msgs.msg import Float64
from std_srvs.srv import Empty

from contract.conftest import Graph


@pytest.mark.parametrize(
    ("written", "full"),
    [("x", "/rig/x"), ("/x", "/x"), ("~/x", "/rig/sim/x"), ("{node}/x", "/rig/sim/x"), ("a/b", "/rig/a/b")],
)
def test_names_expand(graph: Graph, written: str, full: str) -> None:
    node = graph.node("sim", namespace="rig")
    assert node.create_publisher(Float64, written, 10).topic_name == full
    assert node.resolve_service_name(written) == full


@pytest.mark.parametrize("name", ["", "1x", "a//b", "a b", "a/", "a~b", "{x", "ä"])
def test_invalid_names_are_refused(graph: Graph, name: str) -> None:
    node = graph.node("sim")
    with pytest.raises(InvalidTopicNameException):
        node.create_publisher(Float64, name, 10)
    with pytest.raises(InvalidServiceNameException):
        node.create_client(Empty, name)


def test_invalid_nodes_and_namespaces_are_refused(graph: Graph) -> None:
    for name in ("", "a/b", "1a", "a-b"):
        with pytest.raises(InvalidNodeNameException):
            rclpy.create_node(name)
    with pytest.raises(InvalidNamespaceException):
        rclpy.create_node("ok", namespace="/a//b")


def test_remapping_of_topics_services_and_the_node(graph: Graph) -> None:
    rules = ["x:=/elsewhere/x", "/rig/srv:=other", "__ns:=/rig", "__node:=renamed", "someone_else:x:=/nowhere"]
    arguments = ["--ros-args", *(text for rule in rules for text in ("-r", rule))]
    node = graph.node("sim", cli_args=arguments)
    assert node.get_fully_qualified_name() == "/rig/renamed"
    assert node.create_publisher(Float64, "x", 10).topic_name == "/elsewhere/x"
    assert node.resolve_service_name("srv") == "/rig/other"
    assert node.resolve_topic_name("x", only_expand=True) == "/rig/x"


@pytest.mark.parametrize(
    "arguments", [["--ros-args", "-r", "nonsense"], ["--ros-args", "--unknown"], ["--ros-args", "-p", "x"]]
)
def test_arguments_that_make_no_sense_are_refused(arguments: list[str]) -> None:
    context = rclpy.Context()
    with pytest.raises(RuntimeError):
        rclpy.init(args=arguments, context=context)


def test_a_node_needs_init() -> None:
    with pytest.raises(NotInitializedException):
        rclpy.create_node("too_early", context=rclpy.Context())


def test_ros_arguments_end_with_two_dashes_and_the_rest_is_the_programs_own() -> None:
    command = ["node", "--own", "--ros-args", "-r", "x:=y", "-p", "a:=1", "--", "last"]
    assert remove_ros_args(command) == ["node", "--own", "last"]


def test_arguments_set_the_level_of_a_logger() -> None:
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "--log-level", "contract_quiet:=error"], context=context)
    node = rclpy.create_node("contract_quiet", context=context)
    try:
        assert node.get_logger().get_effective_level() == LoggingSeverity.ERROR
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


def test_arguments_name_the_enclave_and_silence_rosout() -> None:
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "--enclave", "/rig", "--disable-rosout-logs"], context=context)
    node = rclpy.create_node("contract_quiet", context=context)
    try:
        assert ("contract_quiet", "/", "/rig") in node.get_node_names_and_namespaces_with_enclaves()
        published = dict(node.get_publisher_names_and_types_by_node("contract_quiet", "/"))
        assert "/parameter_events" in published and "/rosout" not in published
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


def test_global_arguments_reach_every_node_that_does_not_refuse_them() -> None:
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "-r", "x:=y", "-p", "a:=2"], context=context)
    heeding = rclpy.create_node("heeding", context=context)
    refusing = rclpy.create_node("refusing", context=context, use_global_arguments=False)
    try:
        assert [node.resolve_topic_name("x") for node in (heeding, refusing)] == ["/y", "/x"]
        assert [node.declare_parameter("a", 1).value for node in (heeding, refusing)] == [2, 1]
    finally:
        heeding.destroy_node()
        refusing.destroy_node()
        rclpy.shutdown(context=context)
