"""Ten topics at 1 kHz each, from one process to ten subscriptions of another.

Run as `python layer_streams.py receive SECONDS`, which prints how many messages came and the share of one
core that this took, and `... send SECONDS`. Both say `ready` once they have found each other; the sender then begins
with a line on its input and ends with its input.
"""

from __future__ import annotations

import sys
import time
from functools import partial

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64

TOPICS = [f"stream_{number}" for number in range(10)]
PERIOD = 1e-3
QOS = QoSProfile(depth=100)
SILENCE = 3.0  # s; what has not come then is lost


def send(seconds: float) -> None:
    """Publish a number on every topic at each tick; a tick that comes late is made up for."""
    node = rclpy.create_node("benchmark_sender")
    publishers = [node.create_publisher(Float64, topic, QOS) for topic in TOPICS]
    while not all(publisher.get_subscription_count() for publisher in publishers):
        time.sleep(0.01)
    print("ready", flush=True)
    sys.stdin.readline()
    begun = time.monotonic()
    for tick in range(round(seconds / PERIOD)):
        time.sleep(max(0.0, begun + tick * PERIOD - time.monotonic()))
        for publisher in publishers:
            publisher.publish(Float64(data=float(tick)))
    sys.stdin.read()


def receive(seconds: float) -> tuple[int, float]:
    """Return how many different messages came on all topics together, and the share of one core used for it."""
    node, executor = rclpy.create_node("benchmark_receiver"), SingleThreadedExecutor()
    executor.add_node(node)
    heard: set[tuple[str, float]] = set()
    last = 0.0

    def on_message(topic: str, message: Float64) -> None:
        nonlocal last
        heard.add((topic, message.data))
        last = time.monotonic()

    subscriptions = [node.create_subscription(Float64, topic, partial(on_message, topic), QOS) for topic in TOPICS]
    while not all(subscription.get_publisher_count() for subscription in subscriptions):
        executor.spin_once(timeout_sec=0.01)
    print("ready", flush=True)
    while not heard:
        executor.spin_once(timeout_sec=1.0)
    used, begun = time.process_time(), time.monotonic()
    expected = len(TOPICS) * round(seconds / PERIOD)
    while len(heard) < expected and time.monotonic() < last + SILENCE:
        executor.spin_once(timeout_sec=1.0)
    return len(heard), (time.process_time() - used) / (last - begun)


if __name__ == "__main__":
    rclpy.init()
    role, duration = sys.argv[1], float(sys.argv[2])
    if role == "send":
        send(duration)
    else:
        print(*receive(duration))
    rclpy.shutdown()
