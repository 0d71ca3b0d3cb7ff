"""The simulator's command topics: volts as a plain number, or as the effort of the joint, stamped, for ros2_control.

The hardware components of ros2_control publish `joint_command` (joint_state_topic_hardware_interface: JointState) or
`joint_command/effort` (joint_command_topic_hardware_interface: control_msgs/msg/JointCommand, one topic an interface;
ROS 2 Kilted and later). Source: github.com/ros-controls/topic_based_hardware_interfaces.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from eha_sim_node.joints import JOINT, value_of

try:
    from control_msgs.msg import JointCommand
except ImportError:  # a ROS 2 without control_msgs, or with Jazzy's, which has no such message
    JointCommand = None

INTERFACE = "effort"


def newest() -> QoSProfile:
    """Where the clock drives time: the newest command alone counts, from reliable and best-effort publishers alike."""
    return QoSProfile(depth=1, reliability=QoSReliabilityPolicy.BEST_EFFORT)


def each() -> QoSProfile:
    """Where commands drive time: each one counts, so none may be lost."""
    return QoSProfile(depth=500)


class CommandTopics:
    """Hands on the voltage of each command, whatever its topic.

    Args:
        node: owner of the subscriptions.
        offer: called with each command's voltage [V].
        quality: makes the QoS of a subscription (one each: parameters `qos_overrides...` may change it).
    """

    def __init__(self, node: Node, offer: Callable[[float], None], quality: Callable[[], QoSProfile]) -> None:
        self._node = node
        self._offer = offer
        self.nameless = 0
        self._types = {"voltage_command": "std_msgs/msg/Float64", "joint_command": "sensor_msgs/msg/JointState"}
        receivers: dict[str, tuple[Any, Callable[[Any], None]]] = {
            "voltage_command": (Float64, self._on_voltage),
            "joint_command": (JointState, self._on_joint_state),
        }
        if JointCommand is not None:
            receivers[f"joint_command/{INTERFACE}"] = (JointCommand, self._on_joint_command)
            self._types[f"joint_command/{INTERFACE}"] = "control_msgs/msg/JointCommand"
        self._subscriptions = {
            topic: node.create_subscription(
                message_type,
                topic,
                receive,
                quality(),
                qos_overriding_options=QoSOverridingOptions.with_default_policies(),
            )
            for topic, (message_type, receive) in receivers.items()
        }

    @property
    def commanders(self) -> int:
        """How many publishers are matched."""
        return sum(subscription.get_publisher_count() for subscription in self._subscriptions.values())

    def troubles(self) -> list[str]:
        """What keeps somebody's commands from acting, or lets them fight: one line each."""
        troubles = [trouble for topic in self._types for trouble in self._ignored(topic)]
        used = [topic for topic, subscription in self._subscriptions.items() if subscription.get_publisher_count()]
        if self.commanders > 1:
            troubles.append(f"{self.commanders} publishers on {' and '.join(used)}")
        if self.nameless:
            troubles.append(f"{self.nameless} commands ignored: no {INTERFACE} of a joint {JOINT} in them")
            self.nameless = 0
        return troubles

    def _ignored(self, topic: str) -> list[str]:
        """Publishers of a topic that DDS does not match with the subscription, which nobody else would tell."""
        wanted = self._types[topic]
        reliable = self._subscriptions[topic].qos_profile.reliability == QoSReliabilityPolicy.RELIABLE
        troubles = []
        for info in self._node.get_publishers_info_by_topic(topic):
            if info.topic_type != wanted:
                troubles.append(f"{topic} of type {info.topic_type} from {info.node_name} is ignored; publish {wanted}")
            elif reliable and info.qos_profile.reliability == QoSReliabilityPolicy.BEST_EFFORT:
                troubles.append(
                    f"{topic} from {info.node_name} is ignored: it is best effort, and in lockstep no command may be"
                    " lost; publish it reliable"
                )
        return troubles

    def _on_voltage(self, message: Float64) -> None:
        self._offer(message.data)

    def _on_joint_state(self, message: JointState) -> None:
        self._take(value_of(message.name, message.effort))

    def _on_joint_command(self, message: Any) -> None:
        values = message.values if message.interface_name == INTERFACE else ()
        self._take(value_of(message.joint_names, values))

    def _take(self, voltage: float | None) -> None:
        if voltage is None:
            self.nameless += 1
        else:
            self._offer(voltage)
