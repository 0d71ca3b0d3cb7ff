"""The two ends of an exchange over DDS: a node of whichever rclpy is present, and plain Cyclone DDS for Python.

Both send and hear one type of message, reliably and with nothing left out, and hand what they hear to a function.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any, Protocol

import rclpy
import rclpy.executors
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from rclpy.qos import HistoryPolicy, QoSProfile
from sensor_msgs.msg import Image, JointState
from std_msgs.msg import Float64

import layer_types as plain

PIXELS = bytes(range(250)) * 400  # 100 kB
VALUES = [0.1, -2.5, math.pi]
TAKEN_AT_ONCE = 64  # samples that the plain end takes from its reader in one call


class End(Protocol):
    """One end: sends, waits, and says whether it has found the other."""

    message: Any

    def send(self, message: Any) -> None: ...
    def spin_once(self, timeout: float) -> None: ...
    def matched(self) -> bool: ...


class Node:
    """A node with one publisher and one subscription, and an executor of its own."""

    def __init__(self, kind: str, writes: str, reads: str, on_message: Callable[[Any], object]) -> None:
        self.message = ros_message(kind)
        rclpy.init()
        node = rclpy.create_node(f"benchmark_{kind}_{os.getpid()}")
        qos = QoSProfile(history=HistoryPolicy.KEEP_ALL)
        self._publisher = node.create_publisher(type(self.message), writes, qos)
        self._subscription = node.create_subscription(type(self.message), reads, on_message, qos)
        self._executor = rclpy.executors.SingleThreadedExecutor()
        self._executor.add_node(node)
        self.send = self._publisher.publish

    def spin_once(self, timeout: float) -> None:
        self._executor.spin_once(timeout_sec=timeout)

    def matched(self) -> bool:
        return bool(self._publisher.get_subscription_count() and self._subscription.get_publisher_count())


class Plain:
    """A plain Cyclone DDS writer and reader with a wait set, types declared by hand."""

    def __init__(self, kind: str, writes: str, reads: str, on_message: Callable[[Any], object]) -> None:
        self.message = plain_message(kind)
        participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
        qos = Qos(Policy.Reliability.Reliable(duration(infinite=True)), Policy.History.KeepAll)
        data_type = type(self.message)
        self._writer = DataWriter(participant, Topic(participant, writes, data_type), qos)
        self._reader = DataReader(participant, Topic(participant, reads, data_type), qos)
        self._on_message = on_message
        self._waitset = WaitSet(participant)
        self._waitset.attach(ReadCondition(self._reader, ViewState.Any | InstanceState.Alive | SampleState.NotRead))
        self.send = self._writer.write

    def spin_once(self, timeout: float) -> None:
        self._waitset.wait(duration(seconds=timeout))
        for sample in self._reader.take(TAKEN_AT_ONCE):
            self._on_message(sample)

    def matched(self) -> bool:
        return bool(self._writer.get_matched_subscriptions() and self._reader.get_matched_publications())


ENDS: dict[str, Callable[[str, str, str, Callable[[Any], object]], End]] = {"node": Node, "plain": Plain}
KINDS = ("Float64", "JointState", "Image")


def ros_message(kind: str) -> Any:
    """Return a message of a kind."""
    if kind == "Float64":
        return Float64(data=math.pi)
    if kind == "JointState":
        return JointState(name=["a", "b", "c"], position=VALUES, velocity=VALUES, effort=VALUES)
    return Image(height=250, width=400, encoding="mono8", step=400, data=PIXELS)


def plain_message(kind: str) -> Any:
    """Return the same as a plain type."""
    header = plain.Header(plain.Time(0, 0), "")
    if kind == "Float64":
        return plain.Float64(math.pi)
    if kind == "JointState":
        return plain.JointState(header, ["a", "b", "c"], VALUES, VALUES, VALUES)
    return plain.Image(header, 250, 400, "mono8", 0, 400, PIXELS)
