"""Joining and leaving the graph, and the functions that spin."""

from __future__ import annotations

import contextlib
import os
import time

import pytest
import rclpy
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Float64

from contract.conftest import Graph


def test_a_context_is_between_init_and_shutdown() -> None:
    context = rclpy.Context()
    assert not context.ok()
    rclpy.init(args=[], context=context)
    assert context.ok() and rclpy.ok(context=context)
    with pytest.raises(RuntimeError):
        rclpy.init(args=[], context=context)
    rclpy.shutdown(context=context)
    assert not rclpy.ok(context=context)
    with pytest.raises(RuntimeError):
        rclpy.shutdown(context=context)
    rclpy.try_shutdown(context=context)


def test_the_default_context_may_begin_again() -> None:
    for _ in range(2):
        rclpy.init(args=[])
        assert rclpy.ok()
        rclpy.create_node("brief").destroy_node()
        rclpy.shutdown()
        assert not rclpy.ok()


def test_shutdown_is_told_to_who_asked() -> None:
    context, received = rclpy.Context(), []
    rclpy.init(args=[], context=context)
    context.on_shutdown(lambda: received.append("received"))
    assert received == []
    rclpy.shutdown(context=context)
    assert received == ["received"]


def test_contexts_are_in_domains_of_their_own() -> None:
    own = int(os.environ["ROS_DOMAIN_ID"])
    contexts = {own: rclpy.Context(), own - 1: rclpy.Context()}
    for number, context in contexts.items():
        rclpy.init(args=[], context=context, domain_id=number)
    nodes = [Node(f"in_{context.get_domain_id()}", context=context) for context in contexts.values()]
    time.sleep(0.5)  # long enough to be found, were they in one domain
    try:
        assert [node.get_node_names() for node in nodes] == [[f"in_{number}"] for number in contexts]
    finally:
        for node, context in zip(nodes, contexts.values(), strict=True):
            node.destroy_node()
            rclpy.shutdown(context=context)


def test_a_domain_below_zero_is_refused() -> None:
    with pytest.raises(RuntimeError):
        rclpy.init(args=[], context=rclpy.Context(), domain_id=-1)


def test_the_functions_spin_a_node_until_they_are_told(graph: Graph) -> None:
    node, calls = rclpy.create_node("spun"), []
    timer = node.create_timer(0.02, lambda: calls.append(1))
    rclpy.spin_once(node, timeout_sec=5.0)
    assert calls == [1]
    timer.cancel()
    begun = time.monotonic()
    rclpy.spin_once(node, timeout_sec=0.1)
    assert calls == [1] and time.monotonic() - begun < 2.0
    future = Future()
    node.create_timer(0.02, lambda: future.set_result("done"))
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    assert future.result() == "done"
    node.destroy_node()


def test_spinning_ends_with_the_executor_and_with_the_context(graph: Graph) -> None:
    node, executor = rclpy.create_node("spun"), SingleThreadedExecutor()
    timer = node.create_timer(0.02, lambda: executor.shutdown(0))
    executor.add_node(node)
    executor.spin()
    node.destroy_timer(timer)
    node.create_timer(0.02, rclpy.shutdown)
    with contextlib.suppress(ExternalShutdownException):
        rclpy.spin(node)
    assert not rclpy.ok()
    node.destroy_node()


def test_what_was_destroyed_cannot_be_used(graph: Graph) -> None:
    node = graph.node("owner")
    publisher = node.create_publisher(Float64, "x", 10)
    assert node.destroy_publisher(publisher)
    assert not node.destroy_publisher(publisher)
    with pytest.raises(InvalidHandle):
        publisher.publish(Float64())


def test_a_future_tells_its_result_its_error_and_its_end() -> None:
    received: list[str] = []
    future = Future()
    future.add_done_callback(lambda done: received.append(done.result()))
    assert not future.done()
    future.set_result("value")
    assert future.done() and received == ["value"]
    failed = Future()
    failed.set_exception(ValueError("why"))
    assert isinstance(failed.exception(), ValueError)
    with pytest.raises(ValueError, match="why"):
        failed.result()
    given_up = Future()
    given_up.cancel()
    assert given_up.cancelled()
