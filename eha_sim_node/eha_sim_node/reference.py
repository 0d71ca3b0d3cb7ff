"""The reference node: a signal as voltage command, or as position reference for a user's controller."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping

import rclpy
import rclpy.node
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger

from eha_core.errors import ParameterError
from eha_core.plant import Plant
from eha_core.realtime import NANOSECONDS
from eha_core.signals import Signal, make_signal, signals
from eha_sim_node.diagnostics import Diagnostics, Report
from eha_sim_node.joints import JOINT
from eha_sim_node.parameters import ParameterSet, Row, Value, plant_rows, plant_values
from eha_sim_node.running import run
from eha_sim_node.sample_count import SampleCount
from eha_sim_node.stamps import nanoseconds_of, set_stamp
from eha_sim_node.state_topics import OUTPUT_QUALITY

NAME = "eha_reference"
_SETTLE = 0.5  # s
_LISTENERS_CHECK = 0.05  # s
_LAST_ARRIVES = 5.0  # s; how long the last message may take to every subscriber
OWN_ROWS = (
    Row("mode", "voltage", "what the signal is: volts for the valve, or metres for a controller", fixed=True,
        choices=("voltage", "position")),
    Row("rate", 500.0, "rate of the signal where a timer drives it [Hz]", 0.1, 10_000.0, fixed=True),
    Row("lockstep", False, "whether each joint_states is answered with one sample, instead of a timer", fixed=True),
    Row("leakage_free_response", False,
        "in mode voltage: whether `reference` is the response of this actuator without internal leakage", fixed=True),
    Row("step_size", 1e-4, "step of that response [s]", 1e-6, 1e-3, fixed=True),
    Row("listeners", 1, "how many subscribers the signal waits for", 1, 100, fixed=True),
    Row("duration", 0.0, "time after which the signal is zero and the node ends [s]; 0: never", 0.0, 1e6, fixed=True),
    Row("diagnostics_rate", 1.0, "rate of /diagnostics where a timer drives the signal, in wall-clock time [Hz]",
        0.1, 100.0, fixed=True),
)  # fmt: skip


def signal_rows() -> list[Row]:
    """Return the choice of signal and every signal's parameters, as `<signal>.<parameter>`."""
    rows = [Row("signal", "sine", "shape of the signal", choices=tuple(signals()))]
    for name, signal in signals().items():
        for row in signal.parameters():
            unit = {"same": " [V or m]", "": ""}.get(row.unit, f" [{row.unit}]")
            rows.append(Row(f"{name}.{row.name}", row.default, f"{row.meaning}{unit}", row.lower, row.upper))
    return rows


def chosen_signal(values: Mapping[str, Value]) -> Signal:
    """Return the signal that the parameters describe, or raise ParameterError."""
    name = values["signal"]
    made = make_signal(name, {row.name: values[f"{name}.{row.name}"] for row in signals()[name].parameters()})
    made.value(0.0)  # a signal from a file says here that it has none
    return made


class LeakageFreeActuator:
    """The actuator without internal leakage, driven by the same voltage."""

    def __init__(self, parameters: Mapping[str, float], step_size: float) -> None:
        self._plant = Plant({**parameters, "internal_leakage": 0.0}, step_size)
        self._step_ns = round(step_size * NANOSECONDS)
        self._voltage = 0.0
        self._plant.advance(0.0, 1)  # compiled before anybody waits for it
        self.reset()

    def change(self, parameters: Mapping[str, float]) -> None:
        """Change parameters of the actuator, or raise ParameterError; it stays free of internal leakage."""
        self._plant.set_parameters({**parameters, "internal_leakage": 0.0})

    def respond(self, elapsed: int, voltage: float) -> tuple[float, float]:
        """Return position and velocity at `elapsed` [ns], from where on `voltage` holds."""
        self._plant.advance(self._voltage, elapsed // self._step_ns - self._plant.step_count)
        self._voltage = voltage
        state = self._plant.state
        return state.position, state.velocity

    def reset(self) -> None:
        """Back to rest."""
        self._plant.reset()
        self._voltage = 0.0


class ReferenceNode(rclpy.node.Node):
    """Parameters -> signal; timer or joint_states -> one sample -> voltage_command and reference."""

    def __init__(self) -> None:
        super().__init__(NAME, automatically_declare_parameters_from_overrides=True)
        responds = self.has_parameter("leakage_free_response") and self.get_parameter("leakage_free_response").value
        self._settings = ParameterSet(self, (*OWN_ROWS, *signal_rows(), *(plant_rows() if responds else [])))
        own = self._settings.values
        if responds and own["mode"] != "voltage":
            raise ParameterError("leakage_free_response answers a voltage; give mode:=voltage")
        self._signal = chosen_signal(own)
        self._duration = own["duration"]
        self._least_listeners = own["listeners"]
        self._commands_voltage = own["mode"] == "voltage"
        self._actuator = LeakageFreeActuator(plant_values(own), own["step_size"]) if responds else None
        self._origin: int | None = None
        self._listeners = 0
        self._still_since = 0.0
        self._voltage_publisher = (
            self.create_publisher(Float64, "voltage_command", OUTPUT_QUALITY) if self._commands_voltage else None
        )
        self._reference_publisher = (
            self.create_publisher(JointState, "reference", OUTPUT_QUALITY)
            if self._actuator or not self._commands_voltage
            else None
        )
        self._reference = JointState(name=[JOINT])
        self._count = SampleCount(own["rate"])
        self._voltage = Float64()
        self._settings.declare(self._apply)
        self.create_service(Trigger, "~/reset", self._on_reset)
        self._unanswered: int | None = None  # stamp of a tick that waits for its sample [ns]
        if own["lockstep"]:
            steady = Clock(clock_type=ClockType.STEADY_TIME)
            self.create_timer(_LISTENERS_CHECK, self._answer_when_heard, clock=steady)
            self.create_subscription(JointState, "joint_states", self._on_joint_states, OUTPUT_QUALITY)
        else:
            simulated = self.get_parameter("use_sim_time").value
            self._steady = self.get_clock() if simulated else Clock(clock_type=ClockType.STEADY_TIME)
            self.create_timer(1.0 / own["rate"], self._on_timer, clock=self._steady)
            self._diagnostics = Diagnostics(self, own["diagnostics_rate"], lambda: Report(*self._count.report()))
        self.get_logger().info(f"{own['mode']}: {own['signal']}")

    def _on_joint_states(self, message: JointState) -> None:
        self._unanswered = nanoseconds_of(message.header.stamp)
        self._answer_when_heard()

    def _answer_when_heard(self) -> None:
        """In lockstep the simulator waits for the first voltage, and so for all who are to hear it."""
        begun = self._origin is not None or not self._commands_voltage
        if self._unanswered is not None and (begun or self._subscribers() >= self._least_listeners):
            stamp, self._unanswered = self._unanswered, None
            self._sample(stamp, stamp)

    def _on_timer(self) -> None:
        if self._origin is not None or self._is_heard():
            now = self._steady.now().nanoseconds
            self._count.sample(now)
            self._sample(now, self.get_clock().now().nanoseconds)

    def _is_heard(self) -> bool:
        """Whether subscribers are there and have been the same for some time.

        The piston integrates the voltage: if a signal began before the simulator listens, it would stay beside its
        reference for good.
        """
        listeners = self._subscribers()
        if listeners != self._listeners:
            self._listeners, self._still_since = listeners, time.monotonic()
        return listeners >= self._least_listeners and time.monotonic() - self._still_since > _SETTLE

    def _subscribers(self) -> int:
        publisher = self._voltage_publisher or self._reference_publisher
        return publisher.get_subscription_count() if publisher else 0

    def _sample(self, now: int, stamp: int) -> None:
        """Publish the signal's value at `now` [ns], under `stamp` [ns]."""
        if self._origin is None:
            self._origin = now
        elapsed = now - self._origin
        if 0.0 < self._duration <= elapsed / NANOSECONDS:
            self._end()
            return
        value = float(self._signal.value(elapsed / NANOSECONDS))
        if self._voltage_publisher is not None:
            self._voltage.data = value
            self._voltage_publisher.publish(self._voltage)
        if self._actuator is not None:
            self._publish_reference(*self._actuator.respond(elapsed, value), stamp)
        elif not self._commands_voltage:
            self._publish_reference(value, float(self._signal.derivative(elapsed / NANOSECONDS)), stamp)

    def _end(self) -> None:
        """Leave the valve at rest, give the last message time to leave, and end the node."""
        self.get_logger().info(f"{self._duration:g} s are over")
        if self._voltage_publisher is not None:
            self._voltage.data = 0.0
            self._voltage_publisher.publish(self._voltage)
            # a recorder that another process keeps from the processor is behind
            self._voltage_publisher.wait_for_all_acked(Duration(seconds=_LAST_ARRIVES))
        time.sleep(_SETTLE)
        rclpy.shutdown()

    def _publish_reference(self, position: float, velocity: float, stamp: int) -> None:
        if self._reference_publisher is None:
            return
        set_stamp(self._reference.header.stamp, stamp)
        self._reference.position = [position]
        self._reference.velocity = [velocity]
        self._reference_publisher.publish(self._reference)

    def _apply(self, changes: Mapping[str, Value]) -> None:
        signal = chosen_signal({**self._settings.values, **changes})
        if self._actuator:
            self._actuator.change(plant_values(changes))
        self._signal = signal

    def _on_reset(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._origin = None
        self._count.restart()
        if self._actuator:
            self._actuator.reset()
        response.success = True
        response.message = "the signal starts anew with the next sample"
        return response


def main() -> int:
    """Run the reference node."""
    return run(ReferenceNode, NAME, OWN_ROWS)


if __name__ == "__main__":
    sys.exit(main())
