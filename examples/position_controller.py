"""A proportional position controller, written as a user of the actuator would write it.

    ros2 run eha_sim_node sim
    ros2 run eha_sim_node reference --ros-args -p mode:=position -p lockstep:=true -p sine.amplitude:=0.01
    python3 examples/position_controller.py --ros-args -p gain:=5.0

The reference answers each measured position with one of the same stamp, and the controller each such pair with one
voltage. So the same three commands run in real time and, with `-p time_mode:=lockstep` for the simulator, in lockstep.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class AnsweringController(Node, ABC):
    """Answers each reference and measured position of one instant with the voltage of its law."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.reference = JointState()
        self.measured = JointState()
        self.voltage = self.create_publisher(Float64, "voltage_command", 10)
        self.create_subscription(JointState, "reference", self.on_reference, 10)
        self.create_subscription(JointState, "joint_states", self.on_measured, 10)

    def on_reference(self, message: JointState) -> None:
        """Take a reference."""
        self.reference = message
        self.control()

    def on_measured(self, message: JointState) -> None:
        """Take a measurement."""
        self.measured = message
        self.control()

    def control(self) -> None:
        """Publish the voltage once both are there for one instant."""
        reference, measured = self.reference, self.measured
        if not reference.position or not measured.position or reference.header.stamp != measured.header.stamp:
            return
        wanted, found = reference.name.index("piston"), measured.name.index("piston")
        position = reference.position[wanted]
        voltage = self.law(position, reference.velocity[wanted], position - measured.position[found])
        self.voltage.publish(Float64(data=voltage))

    @abstractmethod
    def law(self, position: float, velocity: float, error: float) -> float:
        """The voltage [V] for a reference [m, m/s] and the error of the position [m]."""


class PositionController(AnsweringController):
    """voltage = gain (reference - position) + feedforward reference velocity."""

    def __init__(self) -> None:
        super().__init__("position_controller")
        self.declare_parameter("gain", 5.0)  # V/m
        self.declare_parameter("feedforward", 0.0)  # V/(m/s)

    def law(self, position: float, velocity: float, error: float) -> float:
        return self.get_parameter("gain").value * error + self.get_parameter("feedforward").value * velocity


def run(controller: type[Node]) -> None:
    """Run a controller until a signal ends it."""
    rclpy.init()
    try:
        rclpy.spin(controller())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    run(PositionController)
