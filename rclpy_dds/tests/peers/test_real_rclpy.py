"""Topics between the layer and a real rclpy on Fast DDS, both ways; `make contract` makes that rclpy's environment."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

PYTHON = Path(__file__).resolve().parents[3] / ".venv-rclpy" / "bin" / "python"
DOMAIN = 46 + os.getpid() % 56

pytestmark = pytest.mark.skipif(
    not PYTHON.exists() or "rclpy_dds" not in rclpy.__file__, reason="no .venv-rclpy; `make contract` makes it"
)


@pytest.fixture
def peer(monkeypatch: pytest.MonkeyPatch) -> Iterator[subprocess.Popen[str]]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    command = [str(PYTHON), str(Path(__file__).with_name("real_peer.py"))]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        yield process
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()


def test_topics_go_both_ways_and_standing_ones_arrive_late(peer: subprocess.Popen[str]) -> None:
    assert peer.stdout.readline().strip() == "rmw_fastrtps_cpp"
    context = rclpy.Context()
    rclpy.init(context=context)
    executor = SingleThreadedExecutor(context=context)
    node = rclpy.create_node("layer_peer", context=context)
    executor.add_node(node)
    heard: list[JointState] = []
    standing: list[JointState] = []
    there = node.create_publisher(JointState, "there", 100)
    node.create_subscription(JointState, "back", heard.append, 100)
    latched = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(JointState, "standing", standing.append, latched)

    def spin_until(condition) -> bool:
        deadline = time.monotonic() + 20
        while not condition() and time.monotonic() < deadline:
            executor.spin_once(timeout_sec=0.05)
        return bool(condition())

    try:
        assert spin_until(lambda: there.get_subscription_count() and node.count_publishers("back"))
        assert spin_until(lambda: standing) and standing[0].position[0] == 0.25
        sent = []
        for number in range(20):
            message = JointState(name=["piston", "é"], position=[0.1 * number], velocity=[], effort=[float(number)] * 3)
            message.header.stamp.sec, message.header.frame_id = number, "base"
            there.publish(message)
            sent.append(message)
            assert spin_until(lambda number=number: len(heard) > number)
        assert heard == sent
        assert spin_until(lambda: ("real_peer", "/") in node.get_node_names_and_namespaces())
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)


def test_a_list_is_whole_at_once(peer: subprocess.Popen[str]) -> None:
    assert peer.stdout.readline().strip() == "rmw_fastrtps_cpp"
    ros2 = [sys.executable, "-m", "rclpy_dds.commands.main"]
    for what, names in (("node", {"/real_peer"}), ("topic", {"/back", "/standing", "/there"})):
        for _ in range(3):  # Fast DDS tells its endpoints and nodes at a moment between 0.05 and 3 s
            found = subprocess.run([*ros2, what, "list"], check=True, capture_output=True, text=True).stdout.split()
            assert names <= set(found)
