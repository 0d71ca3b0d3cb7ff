"""Times, durations and clocks."""

from __future__ import annotations

from time import monotonic, time_ns

import pytest
from rclpy.clock import Clock, JumpThreshold
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage

from contract.conftest import Graph


def test_arithmetic_keeps_nanoseconds() -> None:
    time = Time(seconds=5, nanoseconds=1, clock_type=ClockType.ROS_TIME)
    assert (time + Duration(seconds=1)).nanoseconds == 6_000_000_001
    assert time - Time(seconds=2, clock_type=ClockType.ROS_TIME) == Duration(seconds=3, nanoseconds=1)
    assert time.seconds_nanoseconds() == (5, 1)
    assert Time.from_msg(time.to_msg()) == time
    assert Duration.from_msg(Duration(nanoseconds=-1).to_msg()) == Duration(nanoseconds=-1)


def test_times_of_different_clocks_do_not_mix() -> None:
    with pytest.raises(TypeError):
        Time(clock_type=ClockType.ROS_TIME) < Time(clock_type=ClockType.SYSTEM_TIME)  # noqa: B015
    with pytest.raises(ValueError):
        Time(nanoseconds=-1)


def test_a_steady_clock_goes_forward() -> None:
    clock = Clock(clock_type=ClockType.STEADY_TIME)
    first = clock.now()
    assert clock.now() >= first


@pytest.mark.parametrize("kind", [ClockType.STEADY_TIME, ClockType.SYSTEM_TIME, ClockType.ROS_TIME])
def test_every_clock_sleeps_as_long_as_it_is_told(graph: Graph, kind: ClockType) -> None:
    clock = graph.node("sleeper").get_clock() if kind == ClockType.ROS_TIME else Clock(clock_type=kind)
    begun = monotonic()
    assert clock.sleep_for(Duration(seconds=0.1))
    assert 0.099 < monotonic() - begun < 1.0
    assert clock.sleep_until(clock.now() - Duration(seconds=1))  # long past: at once
    assert monotonic() - begun < 1.0


def test_the_system_clock_is_the_machines() -> None:
    before = time_ns()
    now = Clock(clock_type=ClockType.SYSTEM_TIME).now().nanoseconds
    assert before <= now <= time_ns()


def _tell(graph: Graph, publisher: object, node: object, seconds: int) -> None:
    publisher.publish(ClockMessage(clock=Time(seconds=seconds).to_msg()))  # type: ignore[attr-defined]
    wanted = seconds * 10**9
    assert graph.spin_until(lambda: node.get_clock().now().nanoseconds == wanted)  # type: ignore[attr-defined]


def test_simulated_time_moves_clock_and_timers(graph: Graph) -> None:
    node = graph.node("simulated", parameter_overrides=[Parameter("use_sim_time", value=True)])
    publisher = graph.node("world").create_publisher(ClockMessage, "/clock", 10)
    assert graph.spin_until(lambda: publisher.get_subscription_count() == 1)
    _tell(graph, publisher, node, 10)
    calls: list[int] = []
    node.create_timer(5.0, lambda: calls.append(node.get_clock().now().nanoseconds))
    _tell(graph, publisher, node, 14)
    assert not graph.spin_until(lambda: calls, 0.1)
    _tell(graph, publisher, node, 15)
    assert graph.spin_until(lambda: calls)
    assert calls == [15 * 10**9]


def test_jumps_are_told(graph: Graph) -> None:
    node = graph.node("simulated", parameter_overrides=[Parameter("use_sim_time", value=True)])
    publisher = graph.node("world").create_publisher(ClockMessage, "/clock", 10)
    assert graph.spin_until(lambda: publisher.get_subscription_count() == 1)
    _tell(graph, publisher, node, 10)
    jumps: list[int] = []
    threshold = JumpThreshold(min_forward=Duration(seconds=3), min_backward=Duration(seconds=-1))
    handle = node.get_clock().create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append(jump.delta.nanoseconds)
    )
    for seconds in (12, 20, 5):
        _tell(graph, publisher, node, seconds)
    assert jumps == [8 * 10**9, -15 * 10**9]
    handle.unregister()
