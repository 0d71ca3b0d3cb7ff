"""A rig to be diagnosed: a second plant, written apart from the simulator, with noisy instruments and nothing else.

    python3 examples/concealed_rig.py SEALED_FILE

It takes volts on voltage_command and publishes position and pressures, one sample for each voltage, while ~/step has
samples left; stamps are its own time, from zero. What it is made of stands in the sealed file and on no topic.
"""

from __future__ import annotations

import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from concealment import Answer, unseal
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64

from eha_exam.truth import SteppedTruth
from eha_interfaces.srv import Step

NAME = "eha_rig"
PERIOD = 2_000_000  # ns between two samples
ATMOSPHERE = 101325.0  # Pa; the message's pressures are absolute
QUALITY = QoSProfile(depth=500)  # a second of samples


class ConcealedRig(Node):
    """voltage_command -> the truth -> joint_states and the chambers' pressures."""

    def __init__(self, answer: Answer) -> None:
        super().__init__(NAME)
        self._truth = SteppedTruth(answer.plant, tuple(answer.effects.items()), 1e9 / PERIOD)
        self._noises = answer.noises
        self._generator = np.random.default_rng([answer.seed, 1])
        self._sample, self._left = -1, 0
        self._voltage: float | None = None
        self._clock = self.create_publisher(Clock, "/clock", QUALITY)
        self._joint = self.create_publisher(JointState, "joint_states", QUALITY)
        self._pressures = [self.create_publisher(FluidPressure, f"chamber_{one}/pressure", QUALITY) for one in "ab"]
        self.create_subscription(Float64, "voltage_command", self._on_voltage, QUALITY)
        self.create_service(Step, "~/step", self._on_step)

    def _on_step(self, request: Step.Request, response: Step.Response) -> Step.Response:
        """Let so many samples pass; each needs the voltage that answers the one before."""
        self._left += request.steps
        if self._sample < 0:
            self._publish()
        self._go_on()
        response.success, response.message = True, f"{self._left} samples to come"
        response.time = self._sample * PERIOD * 1e-9
        return response

    def _on_voltage(self, message: Float64) -> None:
        self._voltage = message.data
        self._go_on()

    def _go_on(self) -> None:
        if self._left and self._voltage is not None:
            self._truth.hold(self._voltage)
            self._voltage = None
            self._left -= 1
            self._publish()

    def _publish(self) -> None:
        """Publish the next sample; joint_states comes last, for that is what the reference answers."""
        self._sample += 1
        stamp = self._sample * PERIOD
        position, velocity, pressure_a, pressure_b = self._truth.sense()
        clock = Clock()
        _set(clock.clock, stamp)
        self._clock.publish(clock)
        for publisher, name, value in zip(
            self._pressures, ("pressure_a", "pressure_b"), (pressure_a, pressure_b), strict=True
        ):
            message = FluidPressure(fluid_pressure=ATMOSPHERE + self._measured(name, value))
            _set(message.header.stamp, stamp)
            publisher.publish(message)
        motion = [self._measured("position", position)], [self._measured("velocity", velocity)]
        joint = JointState(name=["piston"], position=motion[0], velocity=motion[1])
        _set(joint.header.stamp, stamp)
        self._joint.publish(joint)

    def _measured(self, name: str, value: float) -> float:
        return value + self._noises[name] * float(self._generator.standard_normal())


def _set(stamp: Any, nanoseconds: int) -> None:
    stamp.sec, stamp.nanosec = divmod(nanoseconds, 1_000_000_000)


def main() -> str | None:
    """Run the rig until a signal ends it; return what is wrong with the sealed file."""
    if len(sys.argv) < 2:
        return "usage: python3 examples/concealed_rig.py SEALED_FILE"
    try:
        answer, _ = unseal(Path(sys.argv[1]))
    except (OSError, ValueError, zlib.error):
        return f"concealed_rig: {sys.argv[1]}: is no sealed file; examples/concealed_demo.py makes one"
    rclpy.init(args=sys.argv)
    try:
        rclpy.spin(ConcealedRig(answer))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
    return None


if __name__ == "__main__":
    sys.exit(main())
