"""How processes end, what they cost, and what signals may do: more than ROS 2's own rclpy promises."""

from __future__ import annotations

import time

import pytest
import rclpy
from contract.conftest import Graph
from contract.test_processes import Start, _names


def test_a_node_that_returns_is_gone_at_once(graph: Graph, program: Start) -> None:
    graph.node("observer")
    brief = program('import time, rclpy; rclpy.init(); rclpy.create_node("brief"); print("ready"); time.sleep(0.5)')
    brief.wait_for("ready")
    assert graph.spin_until(lambda: "/brief" in _names(graph))
    assert brief.end() == 0
    assert graph.spin_until(lambda: "/brief" not in _names(graph), 1.0)


@pytest.mark.parametrize("end", ["rclpy.shutdown()", "pass", "raise SystemExit('refused')"])
def test_no_thread_of_dds_is_left_when_python_finalises(program: Start, end: str) -> None:
    # One that is left asks for the interpreter lock, is ended for it, and whoever waits for it waits for ever.
    source = """
import atexit, os
def name(task):
    try:
        return open(f"/proc/self/task/{task}/comm").read().strip()
    except OSError:  # it has ended since it was listed
        return ""
def threads():
    return {name(task) for task in os.listdir("/proc/self/task")}
atexit.register(lambda: print("left:", sorted(threads() & {"gc", "tev", "recv", "recvMC", "dq.builtins", "dq.user"})))
import rclpy
rclpy.init()
node = rclpy.create_node("brief")
print("garbage collector runs:", "gc" in threads())
"""
    brief = program(source + end)
    assert brief.wait_for("garbage").strip().endswith("True")
    assert brief.wait_for("left").strip() == "left: []"
    brief.end()


INTERRUPTED = """
import signal, rclpy
from std_msgs.msg import Float64
class Interruption(Exception): pass
def interrupt(*_):
    raise Interruption
rclpy.init()
node = rclpy.create_node("interrupted")
publisher = node.create_publisher(Float64, "numbers", 1000)
subscription = node.create_subscription(Float64, "numbers", print, 1000)
signal.signal(signal.SIGALRM, interrupt)
interruptions = taken = 0
while interruptions < 2000:
    for _ in range(100):
        publisher.publish(Float64(data=1.0))
    try:
        signal.setitimer(signal.ITIMER_REAL, 3e-4)
        while True:
            taken += subscription.take_message() is not None
    except Interruption:
        interruptions += 1
print("took many" if taken > 10000 else f"took only {taken}")
rclpy.shutdown()
"""


def test_a_signal_while_samples_are_taken_crashes_nothing(program: Start) -> None:
    interrupted = program(INTERRUPTED)
    interrupted.wait_for("took many")
    assert interrupted.end() == 0


HELD_OFF = """
import signal, rclpy
from rclpy_dds.wire.interruptions import held_off
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs are born deaf to it
rclpy.init()
try:
    with held_off():
        signal.raise_signal(signal.SIGINT)
        print("in the block", end=", ")
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted after it" if not rclpy.ok() else "still running")
"""


def test_a_signal_while_the_graph_is_read_comes_after_it(program: Start) -> None:
    reading = program(HELD_OFF)
    reading.wait_for("in the block, interrupted after it")
    assert reading.end() == 0


def test_an_idle_node_needs_no_processor(program: Start) -> None:
    source = """
import time, rclpy
rclpy.init()
node = rclpy.create_node("idle")
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)
executor.spin_once(timeout_sec=0.5)
before = time.process_time()
executor.spin_once(timeout_sec=2.0)
print("used", (time.process_time() - before) / 2.0)
"""
    used = float(program(f"import rclpy.executors\n{source}").wait_for("used").split()[1])
    assert used < 0.01


def test_a_callback_costs_less_than_fifty_microseconds(graph: Graph) -> None:
    node, calls, number = graph.node("busy"), [], 500
    node.create_timer(1e-9, lambda: calls.append(1))  # always due

    def seconds() -> float:
        calls.clear()
        begun = time.perf_counter()
        while len(calls) < number:
            graph.executor.spin_once()
        return time.perf_counter() - begun

    # What else the machine does only ever adds time, so the quickest of many short runs is the executor's own.
    assert min(seconds() for _ in range(20)) / number < 50e-6


def test_a_with_statement_ends_what_init_began() -> None:
    for _ in range(2):
        with rclpy.init(args=[]):
            assert rclpy.ok()
        assert not rclpy.ok()
