"""Holds the piston at 10 mm: a hundred times a second, one voltage from the latest measured position."""

from contextlib import suppress

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class Controller(Node):
    def __init__(self) -> None:
        super().__init__("controller")
        self.position = 0.0  # m
        self.voltage = self.create_publisher(Float64, "voltage_command", 1)
        self.create_subscription(JointState, "joint_states", self.on_measured, qos_profile_sensor_data)
        self.create_timer(0.01, self.on_timer)  # s of the node's clock

    def on_measured(self, message: JointState) -> None:
        self.position = message.position[0]

    def on_timer(self) -> None:
        self.voltage.publish(Float64(data=10.0 * (0.01 - self.position)))  # 10 V/m


def main() -> None:
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Controller())


main()
