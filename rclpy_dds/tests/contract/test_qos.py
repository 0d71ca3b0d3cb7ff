"""Quality of service: profiles, compatibility and events."""

from __future__ import annotations

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSCompatibility,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_sensor_data,
)
from std_msgs.msg import Float64

from contract.conftest import Graph


def test_profiles_need_a_depth_where_it_counts() -> None:
    with pytest.raises(InvalidQoSProfileException):
        QoSProfile()
    with pytest.raises(InvalidQoSProfileException):
        QoSProfile(history=HistoryPolicy.KEEP_LAST)
    assert QoSProfile(depth=3) == QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=3)
    assert (qos_profile_sensor_data.reliability, qos_profile_sensor_data.depth) == (ReliabilityPolicy.BEST_EFFORT, 5)


def test_compatibility_is_told() -> None:
    reliable = QoSProfile(depth=1, liveliness=LivelinessPolicy.AUTOMATIC)
    best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, liveliness=LivelinessPolicy.AUTOMATIC)
    assert qos_check_compatible(reliable, best_effort) == (QoSCompatibility.OK, "")
    refused = (QoSCompatibility.ERROR, "ERROR: Best effort publisher and reliable subscription;")
    assert qos_check_compatible(best_effort, reliable) == refused
    waiting = QoSProfile(depth=1, liveliness=LivelinessPolicy.AUTOMATIC, deadline=Duration(seconds=1))
    refused = (QoSCompatibility.ERROR, "ERROR: Subscription has a deadline, but publisher does not;")
    assert qos_check_compatible(reliable, waiting) == refused
    left_open = "WARNING: Publisher liveliness is system_default and subscription liveliness is system_default;"
    assert qos_check_compatible(QoSProfile(depth=1), QoSProfile(depth=1)) == (QoSCompatibility.WARNING, left_open)


def test_endpoints_show_their_profiles_in_the_graph(graph: Graph) -> None:
    node = graph.node("owner")
    node.create_publisher(Float64, "x", QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    node.create_subscription(Float64, "x", lambda _: None, qos_profile_sensor_data)
    assert graph.spin_until(
        lambda: node.get_publishers_info_by_topic("x") and node.get_subscriptions_info_by_topic("x")
    )
    [offered], [asked] = node.get_publishers_info_by_topic("x"), node.get_subscriptions_info_by_topic("x")
    assert offered.node_name == asked.node_name == "owner"
    assert offered.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert offered.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert asked.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
    assert offered.topic_type == "std_msgs/msg/Float64"
    assert str(offered.topic_type_hash).endswith("705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a")


def test_incompatible_endpoints_hear_of_each_other(graph: Graph) -> None:
    node, events = graph.node("owner"), {}
    node.create_publisher(
        Float64, "x", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
        event_callbacks=PublisherEventCallbacks(incompatible_qos=lambda info: events.__setitem__("publisher", info)),
    )  # fmt: skip
    node.create_subscription(
        Float64, "x", lambda _: None, 1,
        event_callbacks=SubscriptionEventCallbacks(
            incompatible_qos=lambda info: events.__setitem__("subscription", info)
        ),
    )  # fmt: skip
    assert graph.spin_until(lambda: len(events) == 2)
    assert all(info.last_policy_kind == QoSPolicyKind.RELIABILITY and info.total_count == 1 for info in events.values())


@pytest.mark.filterwarnings("ignore:QoSEventHandler is deprecated")  # rclpy uses it itself
def test_matches_and_missed_deadlines_are_told(graph: Graph) -> None:
    node, matched, missed = graph.node("owner"), [], []
    qos = QoSProfile(depth=1, deadline=Duration(seconds=0.05))
    publisher = node.create_publisher(
        Float64,
        "x",
        qos,
        event_callbacks=PublisherEventCallbacks(matched=lambda info: matched.append(info.current_count)),
    )
    node.create_subscription(
        Float64, "x", lambda _: None, qos, event_callbacks=SubscriptionEventCallbacks(deadline=missed.append)
    )
    assert graph.spin_until(lambda: matched)
    publisher.publish(Float64())
    assert graph.spin_until(lambda: missed)
    assert matched[-1] == 1 and missed[0].total_count >= 1


def test_a_policy_or_value_that_does_not_exist_is_refused(graph: Graph) -> None:
    with pytest.raises(AssertionError):
        QoSProfile(depth=1, hurry=True)
    with pytest.raises((AssertionError, ValueError)):
        QoSProfile(depth=1, reliability="reliable")
    with pytest.raises(ValueError):
        QoSProfile(depth=1, durability=77)
    node = graph.node("owner")
    with pytest.raises(ValueError):
        node.create_publisher(Float64, "x", -1)
    with pytest.raises(TypeError):
        node.create_publisher(Float64, "x", "reliable")


@pytest.mark.skipif(
    rclpy.get_rmw_implementation_identifier() == "rmw_fastrtps_cpp", reason="Fast DDS 8.4.3 raises no such event here"
)
def test_a_publisher_that_is_gone_is_no_longer_alive(graph: Graph) -> None:
    node, alive = graph.node("owner"), []
    events = SubscriptionEventCallbacks(liveliness=lambda info: alive.append(info.alive_count))
    node.create_subscription(Float64, "x", lambda _: None, 1, event_callbacks=events)
    publisher = node.create_publisher(Float64, "x", 1)
    assert graph.spin_until(lambda: alive and alive[-1] == 1)
    node.destroy_publisher(publisher)
    assert graph.spin_until(lambda: alive[-1] == 0)
