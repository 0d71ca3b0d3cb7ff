"""A node that counts the simulator's joint_states and the steps missing between their stamps.

Run as `python -m benchmarks.subscriber SECONDS PERIOD_NS`; ends so long after the first message, and prints how many
messages came and how many stamps were missing between the first and the last.
"""

from __future__ import annotations

import sys
import time

import rclpy
from sensor_msgs.msg import JointState


def count(seconds: float, period: int) -> tuple[int, int]:
    """Return the messages received and the periods [ns] without one, over so many seconds."""
    rclpy.init()
    node = rclpy.create_node("benchmark_subscriber")
    stamps: list[int] = []

    def on_message(message: JointState) -> None:
        stamps.append(message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec)

    node.create_subscription(JointState, "joint_states", on_message, 1000)
    while not stamps:
        rclpy.spin_once(node, timeout_sec=1.0)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=1.0)
    expected = round((stamps[-1] - stamps[0]) / period) + 1
    rclpy.try_shutdown()
    return len(stamps), expected - len(set(stamps))


if __name__ == "__main__":
    print(*count(float(sys.argv[1]), int(sys.argv[2])))
