"""What a node knows about the graph."""

from __future__ import annotations

import threading

import pytest
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from contract.conftest import Graph

FLOAT, SWITCH = ["std_msgs/msg/Float64"], ["std_srvs/srv/SetBool"]


@pytest.fixture
def observed(graph: Graph) -> Graph:
    """Give an observer, node 0, and a node with one endpoint of each kind, node 1."""
    graph.node("observer")
    node = graph.node("sim", namespace="/rig")
    node.create_publisher(Float64, "volts", 10)
    node.create_subscription(String, "word", lambda _: None, 10)
    node.create_service(SetBool, "switch", lambda request, response: response)
    node.create_client(SetBool, "other")
    return graph


def test_nodes_are_told_by_name_and_namespace(observed: Graph) -> None:
    observer = observed.nodes[0]
    assert observed.spin_until(lambda: "sim" in observer.get_node_names())
    assert set(observer.get_node_names_and_namespaces()) >= {("observer", "/"), ("sim", "/rig")}
    assert observer.wait_for_node("/rig/sim", 5.0)
    assert not observer.wait_for_node("/rig/nobody", 0.1)


def test_topics_and_services_are_told_with_their_types(observed: Graph) -> None:
    observer = observed.nodes[0]
    assert observed.spin_until(
        lambda: (
            {"/rig/volts", "/rig/word"} <= set(dict(observer.get_topic_names_and_types()))
            and "/rig/switch" in dict(observer.get_service_names_and_types())
        )
    )
    topics, services = dict(observer.get_topic_names_and_types()), dict(observer.get_service_names_and_types())
    assert topics["/rig/volts"] == FLOAT and topics["/rig/word"] == ["std_msgs/msg/String"]
    assert services["/rig/switch"] == SWITCH
    assert not any(name.startswith(("rt/", "rq/", "/rt/")) for name in topics)


def test_who_has_which_endpoint_is_told(observed: Graph) -> None:
    observer = observed.nodes[0]
    questions = {
        "/rig/volts": observer.get_publisher_names_and_types_by_node,
        "/rig/word": observer.get_subscriber_names_and_types_by_node,
        "/rig/switch": observer.get_service_names_and_types_by_node,
        "/rig/other": observer.get_client_names_and_types_by_node,
    }
    for name, ask in questions.items():
        assert observed.spin_until(lambda name=name, ask=ask: name in dict(ask("sim", "/rig"))), name
        assert name not in dict(ask("observer", "/"))
    assert dict(questions["/rig/volts"]("sim", "/rig"))["/rig/volts"] == FLOAT
    assert dict(questions["/rig/other"]("sim", "/rig"))["/rig/other"] == SWITCH


def test_one_message_is_waited_for(graph: Graph) -> None:
    publisher = graph.node("speaker").create_publisher(Float64, "x", 10)
    listener = graph.node("listener")
    graph.executor.remove_node(listener)
    graph.nodes[0].create_timer(0.02, lambda: publisher.publish(Float64(data=2.5)))
    ended = threading.Event()
    thread = threading.Thread(target=lambda: graph.spin_until(ended.is_set, 10.0))
    thread.start()
    try:
        assert wait_for_message(Float64, listener, "x", time_to_wait=5.0) == (True, Float64(data=2.5))
    finally:
        ended.set()
        thread.join()
    assert wait_for_message(Float64, listener, "silent", time_to_wait=0.1) == (False, None)
