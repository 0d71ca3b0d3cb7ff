"""Holds the piston at 10 mm: answers each measured position with one voltage."""

from contextlib import suppress

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class Controller(Node):
    def __init__(self) -> None:
        super().__init__("controller")
        self.voltage = self.create_publisher(Float64, "voltage_command", 10)
        self.create_subscription(JointState, "joint_states", self.on_measured, 10)

    def on_measured(self, message: JointState) -> None:
        error = 0.01 - message.position[0]  # m
        self.voltage.publish(Float64(data=10.0 * error))  # 10 V/m


def main() -> None:
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Controller())


main()
