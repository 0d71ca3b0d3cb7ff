"""A controller made of what `eha export controller` wrote: its Python law ahead, a PI loop with its gains behind.

    eha export controller --from out/diagnosis/diagnosis.json --out out/controller
    python3 examples/exported_controller.py --ros-args -p folder:=out/controller

It answers as `position_controller.py` does, and needs of this project the folder alone.
"""

from __future__ import annotations

import sys
from pathlib import Path

import rclpy
import yaml
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64


class ExportedController(Node):
    """voltage = law(reference position, velocity) + p error + i integral of the error."""

    def __init__(self) -> None:
        super().__init__("eha_controller")
        folder = Path(self.declare_parameter("folder", "out/controller").value)
        document = yaml.safe_load((folder / "controllers.yaml").read_text())
        self.period = 1.0 / document["/**/controller_manager"]["ros__parameters"]["update_rate"]
        self.gains = document["/**/pid_controller"]["ros__parameters"]["gains"]["piston"]
        sys.path.insert(0, str(folder))
        from eha_controller import ACTUATOR  # the file in the folder

        self.actuator = ACTUATOR
        self.integral = 0.0  # m s
        self.reference, self.measured = JointState(), JointState()
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
        error = reference.position[wanted] - measured.position[found]
        ahead = self.actuator.follow(reference.position[wanted], reference.velocity[wanted], self.period)
        voltage = ahead + self.gains["p"] * error + self.gains["i"] * self.integral
        limited = min(max(voltage, self.gains["u_clamp_min"]), self.gains["u_clamp_max"])
        if limited == voltage or voltage * error < 0.0:  # conditional integration
            self.integral += error * self.period
        self.voltage.publish(Float64(data=limited))


def main() -> None:
    """Run the controller until a signal ends it."""
    rclpy.init()
    try:
        rclpy.spin(ExportedController())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
