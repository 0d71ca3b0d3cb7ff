"""What an executor costs: for each callback that it runs, and while nothing happens.

Run as `python layer_executor.py callbacks COUNT`; prints the time [s] of one callback of a guard condition,
of a timer, of a subscription, and of a bare loop that calls the same function. Or as `... idle SECONDS`; prints the
share of one core that a node uses while nobody talks to it.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile
from std_msgs.msg import Float64

SETTLING = 2.0  # s; the node has then announced its services to whom it may concern


class Calls:
    """The function that is called, and the time until it was called so often."""

    def __init__(self, executor: SingleThreadedExecutor, count: int) -> None:
        self._executor, self._count = executor, count
        self._left = 0

    def call(self, _: object = None) -> None:
        """Count."""
        self._left -= 1

    def by_executor(self) -> float:
        """Return the time [s] of one call by the executor."""
        return self._seconds(self._executor.spin_once)

    def bare(self) -> float:
        """Return the time [s] of one call by a loop."""
        return self._seconds(self.call)

    def _seconds(self, step: Callable[[], object]) -> float:
        self._left, begun = self._count, time.perf_counter()
        while self._left > 0:
            step()
        return (time.perf_counter() - begun) / self._count


def callbacks(node: Node, executor: SingleThreadedExecutor, count: int) -> list[float]:
    """Return the times [s] of one callback of a guard condition, a timer, a subscription, and of a bare call."""
    calls = Calls(executor, count)

    def again() -> None:
        calls.call()
        guard.trigger()

    guard = node.create_guard_condition(again)
    guard.trigger()
    times = [calls.by_executor()]
    node.destroy_guard_condition(guard)
    timer = node.create_timer(1e-9, calls.call)
    times.append(calls.by_executor())
    node.destroy_timer(timer)
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    publisher = node.create_publisher(Float64, "numbers", everything)
    node.create_subscription(Float64, "numbers", calls.call, everything)
    while not publisher.get_subscription_count():
        executor.spin_once(timeout_sec=0.01)
    for _ in range(count):
        publisher.publish(Float64())
    return [*times, calls.by_executor(), calls.bare()]


def idle(executor: SingleThreadedExecutor, seconds: float) -> float:
    """Return the share of one core that this process uses while its executor waits."""
    _spin(executor, SETTLING)
    before = time.process_time()
    _spin(executor, seconds)
    return (time.process_time() - before) / seconds


def _spin(executor: SingleThreadedExecutor, seconds: float) -> None:
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0.0:
        executor.spin_once(timeout_sec=left)


def main(what: str, number: str) -> None:
    """Measure and print."""
    rclpy.init()
    node, executor = rclpy.create_node("benchmark_executor"), SingleThreadedExecutor()
    executor.add_node(node)
    print(*(callbacks(node, executor, int(number)) if what == "callbacks" else [idle(executor, float(number))]))
    rclpy.shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
