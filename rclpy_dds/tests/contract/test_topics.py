"""Publishers and subscriptions."""

from __future__ import annotations

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty, Float64, String

from contract.conftest import Graph


def test_a_message_arrives_as_it_was_sent(graph: Graph) -> None:
    node, received = graph.node("talker"), []
    publisher = node.create_publisher(JointState, "states", 10)
    node.create_subscription(JointState, "states", received.append, 10)
    sent = JointState(name=["piston", "Kolben ü"], position=[0.1, -2.5], velocity=[], effort=[1e300])
    sent.header.stamp.sec, sent.header.frame_id = 5, "rig"
    publisher.publish(sent)
    assert graph.spin_until(lambda: received)
    assert received == [sent]


def test_an_empty_message_arrives(graph: Graph) -> None:
    node, received = graph.node("talker"), []
    publisher = node.create_publisher(Empty, "tick", 10)
    node.create_subscription(Empty, "tick", received.append, 10)
    publisher.publish(Empty())
    assert graph.spin_until(lambda: received)


def test_a_callback_with_two_arguments_gets_the_message_info(graph: Graph) -> None:
    node, received = graph.node("talker"), []
    publisher = node.create_publisher(Float64, "x", 10)
    node.create_subscription(Float64, "x", lambda message, info: received.append((message.data, info)), 10)
    publisher.publish(Float64(data=1.5))
    assert graph.spin_until(lambda: received)
    value, info = received[0]
    assert value == 1.5
    assert 0 < info["source_timestamp"] <= info["received_timestamp"]


def test_raw_bytes_are_cdr_with_its_header_and_can_be_published(graph: Graph) -> None:
    node, raw, messages = graph.node("talker"), [], []
    publisher = node.create_publisher(Float64, "x", 10)
    node.create_subscription(Float64, "x", raw.append, 10, raw=True)
    node.create_subscription(Float64, "x", messages.append, 10)
    publisher.publish(serialize_message(Float64(data=-0.25)))
    assert graph.spin_until(lambda: raw and messages)
    assert raw[0][:4] == b"\x00\x01\x00\x00" and len(raw[0]) == 12
    assert deserialize_message(raw[0], Float64) == messages[0] == Float64(data=-0.25)


def test_a_late_joiner_gets_the_latched_message(graph: Graph) -> None:
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = graph.node("early").create_publisher(String, "latched", latched)
    for text in ("first", "last"):
        publisher.publish(String(data=text))
    received: list[String] = []
    graph.node("late").create_subscription(String, "latched", received.append, latched)
    assert graph.spin_until(lambda: received)
    assert [message.data for message in received] == ["last"]


def test_a_full_history_keeps_the_newest(graph: Graph) -> None:
    node, received = graph.node("talker"), []
    publisher = node.create_publisher(Float64, "x", 10)
    node.create_subscription(Float64, "x", lambda message: received.append(message.data), 3)
    for value in range(10):
        publisher.publish(Float64(data=float(value)))
    graph.spin_until(lambda: len(received) == 3)
    assert received == [7.0, 8.0, 9.0]


def test_ten_subscriptions_at_a_thousand_hertz_lose_nothing(graph: Graph) -> None:
    node = graph.node("talker")
    qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
    publishers = [node.create_publisher(Float64, f"x{i}", qos) for i in range(10)]
    received: list[list[float]] = [[] for _ in publishers]
    for index, values in enumerate(received):
        node.create_subscription(Float64, f"x{index}", lambda message, values=values: values.append(message.data), qos)
    sent = 0

    def send() -> None:
        nonlocal sent
        for publisher in publishers:
            publisher.publish(Float64(data=float(sent)))
        sent += 1

    timer = node.create_timer(1e-3, send)
    assert graph.spin_until(lambda: sent >= 500, 10.0)
    timer.cancel()
    assert graph.spin_until(lambda: all(len(values) == sent for values in received))
    assert all(values == [float(i) for i in range(sent)] for values in received)


def test_publishing_another_type_is_refused(graph: Graph) -> None:
    publisher = graph.node("talker").create_publisher(Float64, "x", 10)
    with pytest.raises(TypeError):
        publisher.publish(String())


def test_counts_follow_what_is_made_and_destroyed(graph: Graph) -> None:
    node = graph.node("talker")
    publisher = node.create_publisher(Float64, "x", 10)
    subscription = node.create_subscription(Float64, "x", lambda _: None, 10)
    assert graph.spin_until(lambda: publisher.get_subscription_count() == 1 and node.count_publishers("x") == 1)
    node.destroy_subscription(subscription)
    assert graph.spin_until(lambda: publisher.get_subscription_count() == 0 and node.count_subscribers("x") == 0)
