"""The controller node: a position controller of the library between joint_states, reference and voltage_command."""

from __future__ import annotations

import sys
from collections.abc import Mapping

import rclpy.node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from eha_core.control import CONTROLLERS, Controller, Measurement, Target, make_controller
from eha_core.errors import ParameterError
from eha_core.plant import voltage_driven
from eha_sim_node.diagnostics import Diagnostics, Report
from eha_sim_node.joints import value_of
from eha_sim_node.parameters import ParameterSet, Row, Value, plant_rows, plant_values
from eha_sim_node.running import run
from eha_sim_node.stamps import nanoseconds_of
from eha_sim_node.state_topics import OUTPUT_QUALITY

NAME = "eha_controller"
OWN_ROWS = (
    Row("controller", "pid", "the control law", choices=tuple(CONTROLLERS)),
    Row("model", "", "parameters file of the actuator it is made for (fitted.yaml); empty: nominal", fixed=True),
    Row("rate", 500.0, "rate of joint_states, which each get one command [Hz]", 1.0, 10_000.0, fixed=True),
    Row("command_limit", 10.0, "largest voltage that the drive takes, either sign [V]", 0.0, 1000.0, fixed=True),
    Row("diagnostics_rate", 1.0, "rate of /diagnostics, in wall-clock time [Hz]", 0.1, 100.0, fixed=True),
)


class ControllerNode(rclpy.node.Node):
    """joint_states and reference of one stamp -> law -> voltage_command."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        self._settings = ParameterSet(self, (*OWN_ROWS, *self._plant_rows()))
        self._controller = self._make(self._settings.values)
        self._settings.declare(self._apply)
        self._measured: tuple[int, Measurement] | None = None
        self._target: tuple[int, Target] | None = None
        self._commands = self._unusable = self._told_unusable = 0
        self._publisher = self.create_publisher(Float64, "voltage_command", OUTPUT_QUALITY)
        self.create_subscription(JointState, "reference", self._on_reference, OUTPUT_QUALITY)
        self.create_subscription(JointState, "joint_states", self._on_joint_states, OUTPUT_QUALITY)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self._diagnostics = Diagnostics(self, self._settings.values["diagnostics_rate"], self._report)
        self.get_logger().info(f"{self._settings.values['controller']}, waiting for joint_states and reference")

    def _plant_rows(self) -> list[Row]:
        """The actuator's parameters, whose defaults are those of the model's file."""
        given = self.get_parameter("model").value if self.has_parameter("model") else ""
        if not isinstance(given, str):
            raise ParameterError(f"model = {given!r} is no path of a parameters file")
        return plant_rows(voltage_driven(given) if given else None)

    def _make(self, values: Mapping[str, Value]) -> Controller:
        return make_controller(
            values["controller"], plant_values(values), 1.0 / values["rate"], values["command_limit"]
        )

    def _apply(self, changes: Mapping[str, Value]) -> None:
        self._controller = self._make({**self._settings.values, **changes})

    def _on_joint_states(self, message: JointState) -> None:
        fields = (message.position, message.velocity, message.effort)
        position, velocity, force = (value_of(message.name, values) for values in fields)
        if position is None or velocity is None or force is None:
            self._unusable += 1
            return
        self._measured = (nanoseconds_of(message.header.stamp), Measurement(position, velocity, force))
        self._answer()

    def _on_reference(self, message: JointState) -> None:
        position, velocity = value_of(message.name, message.position), value_of(message.name, message.velocity)
        if position is None or velocity is None:
            self._unusable += 1
            return
        self._target = (nanoseconds_of(message.header.stamp), Target(position, velocity))
        self._answer()

    def _answer(self) -> None:
        """Publish the voltage once measurement and target of one instant are there."""
        measured, target = self._measured, self._target
        if measured is None or target is None or measured[0] != target[0]:
            return
        self._commands += 1
        self._publisher.publish(Float64(data=self._controller.voltage(measured[1], target[1])))

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._controller.reset()
        self._measured = self._target = None
        response.success = True
        response.message = "the controller starts anew"
        return response

    def _report(self) -> Report:
        unusable, self._told_unusable = self._unusable - self._told_unusable, self._unusable
        troubles = [f"{unusable} messages without the joint's position, velocity or force"] if unusable else []
        return Report({"controller": self._settings.values["controller"], "commands": self._commands}, troubles)


def main() -> int:
    """Run the controller node."""
    return run(ControllerNode, NAME)


if __name__ == "__main__":
    sys.exit(main())
