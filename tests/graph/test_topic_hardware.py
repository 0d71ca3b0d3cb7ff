"""The messages of ros2_control's joint_state_topic_hardware_interface (1.1), as its source sends and takes them.

The component itself is C++ on ROS 2's libraries and does not run here. What it puts on the wire is few lines: a
command a cycle on a reliable topic of depth 1, one entry in `effort` for each joint that has that command interface,
NaN as long as no controller has written; states on a best-effort topic, entries that are not finite left out, and an
array shorter than `name` breaking the component.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from conftest import Rig
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from eha_interfaces.msg import ActuatorState

CYCLES, INACTIVE, PERIOD = 500, 20, 0.002
GAIN, AHEAD, AMPLITUDE = 40.0, 0.8, 5e-3  # V/m, V/(m/s), m; gains as in eha_description/config/controllers.yaml
ANGULAR = 2 * math.pi * 2.0  # rad/s


class Hardware:
    """The component's side of both topics: a cycle reads, lets the controller write, and sends."""

    def __init__(self, rig: Rig, joints: tuple[str, ...], on_effort: tuple[str, ...]) -> None:
        self._rig, self._joints, self._on_effort = rig, joints, on_effort
        self.position = 0.0  # the state interface, as it was read last
        self.received: list[JointState] = []
        self.publisher = rig.node.create_publisher(JointState, "joint_command", QoSProfile(depth=1))

    def read(self, message: JointState) -> None:
        """Take a state as the component does: by name, each array as long as the names, finite entries alone."""
        self.received.append(message)
        for index, name in enumerate(message.name):
            arrays = [array for array in (message.position, message.velocity, message.effort) if len(array)]
            values = [array[index] for array in arrays]  # the component's own look-up raises beyond the end
            if name in self._joints and math.isfinite(values[0]):
                self.position = values[0]

    def write(self, command: float) -> None:
        """Send the command interfaces."""
        message = JointState(name=list(self._joints), effort=[command] * len(self._on_effort))
        message.header.stamp = self._rig.node.get_clock().now().to_msg()
        self.publisher.publish(message)


def law(cycle: int, position: float) -> float:
    """A position loop with feedforward, as pid_controller closes it."""
    time = cycle * PERIOD
    wanted = AMPLITUDE * math.sin(ANGULAR * time)
    return GAIN * (wanted - position) + AHEAD * AMPLITUDE * ANGULAR * math.cos(ANGULAR * time)


def rmse(rig: Rig, on_state: Callable[[int, JointState], None]) -> float:
    """Root mean square of the tracking error over the cycles [m], in lockstep at 500 Hz."""
    states = rig.hear(ActuatorState, "state")
    cycle = 0

    def on_joint_states(message: JointState) -> None:
        nonlocal cycle
        on_state(cycle, message)
        cycle += 1

    rig.node.create_subscription(JointState, "joint_states", on_joint_states, qos_profile_sensor_data)
    rig.wait(lambda: len(states) > CYCLES, f"{CYCLES} cycles")
    wanted = AMPLITUDE * np.sin(ANGULAR * PERIOD * np.arange(CYCLES + 1))
    errors = wanted - [state.position for state in states[: CYCLES + 1]]
    return float(np.sqrt(np.mean(np.square(errors))))


def test_the_component_drives_the_simulator_with_the_error_that_volts_leave(rig: Rig) -> None:
    """Both loops see every state and answer it once; the component's first cycles, inactive, send NaN."""
    volts = rig.commands
    first = rig.start_sim("time_mode:=lockstep")
    by_volts = rmse(
        rig,
        lambda cycle, message: volts.publish(
            Float64(data=law(cycle, message.position[0]) if cycle >= INACTIVE else 0.0)
        ),
    )
    assert first.end() == 0

    beside = Rig(rig.folder)
    try:
        beside.node.destroy_publisher(beside.commands)
        hardware = Hardware(beside, ("piston",), ("piston",))
        beside.start_sim("time_mode:=lockstep")

        def cycle(number: int, message: JointState) -> None:
            hardware.read(message)
            hardware.write(law(number, hardware.position) if number >= INACTIVE else math.nan)

        by_component = rmse(beside, cycle)
    finally:
        beside.close()
    print(f"RMSE at 500 Hz: {by_volts * 1e6:.4f} um by volts, {by_component * 1e6:.4f} um by JointState")
    assert by_component == by_volts > 0.0
    assert all(
        list(one.name) == ["piston"] and len(one.position) == len(one.velocity) == len(one.effort) == 1
        for one in hardware.received
    )


def test_an_effort_that_may_be_another_joint_s_is_refused(rig: Rig) -> None:
    """Of two joints of which one takes effort the component sends two names and one value."""
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("diagnostics_rate:=5.0")
    hardware, reports = Hardware(rig, ("valve_handle", "piston"), ("piston",)), rig.diagnostics("eha_sim")
    rig.wait(hardware.publisher.get_subscription_count, "the simulator's command input")
    hardware.write(1.0)
    rig.wait(lambda: any("no effort of a joint piston" in report["message"] for report in reports), "the warning", 10)
    assert reports[-1]["commands_accepted"] == "0"
