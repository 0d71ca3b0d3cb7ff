"""Executors, timers, tasks, callback groups and guard conditions."""

from __future__ import annotations

import threading
import time

import pytest
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.executors import MultiThreadedExecutor
from rclpy.task import Future

from contract.conftest import Graph


def test_a_timer_keeps_its_rate(graph: Graph) -> None:
    times: list[float] = []
    graph.node("timer").create_timer(0.01, lambda: times.append(time.monotonic()))
    begun = time.monotonic()
    assert graph.spin_until(lambda: len(times) == 50)
    assert times[-1] - begun == pytest.approx(0.5, abs=0.1)


def test_a_cancelled_timer_rests_until_reset(graph: Graph) -> None:
    calls: list[int] = []
    timer = graph.node("timer").create_timer(0.01, lambda: calls.append(1))
    assert graph.spin_until(lambda: calls)
    timer.cancel()
    calls.clear()
    assert not graph.spin_until(lambda: calls, 0.1)
    timer.reset()
    assert graph.spin_until(lambda: calls)


def test_an_exception_in_a_callback_reaches_the_spinner(graph: Graph) -> None:
    def fail() -> None:
        raise ValueError("from the callback")

    graph.node("timer").create_timer(0.01, fail)
    with pytest.raises(ValueError, match="from the callback"):
        graph.spin_until(lambda: False, 2.0)


def test_a_guard_condition_wakes_a_waiting_executor(graph: Graph) -> None:
    woken: list[float] = []
    guard = graph.node("guarded").create_guard_condition(lambda: woken.append(time.monotonic()))
    begun = time.monotonic()
    threading.Timer(0.1, guard.trigger).start()
    graph.executor.spin_once(timeout_sec=5.0)
    while not woken and time.monotonic() - begun < 5.0:
        graph.executor.spin_once(timeout_sec=5.0)
    assert 0.09 < woken[0] - begun < 1.0


def test_coroutines_and_tasks(graph: Graph) -> None:
    future, order = Future(), []

    async def wait() -> str:
        order.append("waiting")
        order.append(await future)
        return "finished"

    task = graph.executor.create_task(wait)
    graph.node("timer").create_timer(0.05, lambda: future.set_result("woken"))
    assert graph.spin_until(task.done)
    assert order == ["waiting", "woken"] and task.result() == "finished"


def test_spin_until_future_complete_returns_at_the_result_or_in_time(graph: Graph) -> None:
    node, future = graph.node("timer"), Future()
    begun = time.monotonic()
    graph.executor.spin_until_future_complete(future, timeout_sec=0.1)
    assert not future.done() and 0.09 < time.monotonic() - begun < 1.0
    node.create_timer(0.05, lambda: future.set_result(7))
    graph.executor.spin_until_future_complete(future, timeout_sec=5.0)
    assert future.result() == 7


@pytest.mark.parametrize(("group", "most"), [(MutuallyExclusiveCallbackGroup, 1), (ReentrantCallbackGroup, 2)])
def test_groups_decide_what_runs_at_the_same_time(graph: Graph, group: type, most: int) -> None:
    node, shared = rclpy.create_node("groups"), group()
    running, seen, lock, enough = 0, [], threading.Lock(), threading.Event()

    def work() -> None:
        nonlocal running
        with lock:
            running += 1
            seen.append(running)
        time.sleep(0.03)
        with lock:
            running -= 1
            if len(seen) >= 10:
                enough.set()

    for _ in range(2):
        node.create_timer(0.005, work, callback_group=shared)
    executor = MultiThreadedExecutor(3)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    try:
        assert enough.wait(5.0)
    finally:
        executor.shutdown(2.0)
        thread.join(5.0)
        node.destroy_node()
    assert max(seen) == most if most == 1 else max(seen) >= most


def test_a_rate_sleeps_to_its_beat(graph: Graph) -> None:
    node = graph.node("rate")
    rate = node.create_rate(50.0, Clock(clock_type=ClockType.STEADY_TIME))
    stop = threading.Event()
    thread = threading.Thread(target=lambda: graph.spin_until(stop.is_set, 10.0))
    thread.start()
    begun = time.monotonic()
    for _ in range(10):
        rate.sleep()
    elapsed = time.monotonic() - begun
    stop.set()
    thread.join()
    assert elapsed == pytest.approx(0.2, abs=0.1)


def test_a_node_may_come_and_go_while_others_spin(graph: Graph) -> None:
    calls: list[int] = []
    graph.node("stays").create_timer(0.002, lambda: calls.append(1))
    for _ in range(20):
        node = graph.node("passes")
        node.create_timer(0.001, lambda: calls.append(2))
        calls.clear()
        assert graph.spin_until(lambda: {1, 2} <= set(calls))
        graph.executor.remove_node(node)
        node.destroy_node()
    calls.clear()
    assert not graph.spin_until(lambda: 2 in calls, 0.05)
