"""The simulator's command topics: what ros2_control's topic hardware sends drives it exactly as volts do."""

from __future__ import annotations

import itertools
import math

import numpy as np
from conftest import Rig
from control_msgs.msg import JointCommand
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from eha_core.plant import Plant
from eha_interfaces.msg import ActuatorState
from eha_sim_node.joints import value_of

BEST_EFFORT = QoSProfile(depth=1, reliability=QoSReliabilityPolicy.BEST_EFFORT)
AS_HARDWARE = QoSProfile(depth=1)
PERIODS = 100


def joint_state(volts: float) -> JointState:
    """As a hardware component with another joint beside the piston sends it."""
    return JointState(name=["valve_handle", "piston"], effort=[99.0, volts])


def joint_command(volts: float) -> JointCommand:
    return JointCommand(joint_names=["piston"], interface_name="effort", values=[volts])


def voltage_at(tick: int) -> float:
    return 0.02 * math.sin(2 * math.pi * 5 * tick * 0.002)


def test_the_joint_is_found_by_its_name() -> None:
    assert value_of(["a", "piston"], [1.0, 2.0]) == 2.0
    assert value_of(["a"], [1.0]) is None
    assert value_of(["a", "piston"], [1.0]) is None


def test_every_form_of_command_moves_the_piston_as_volts_do(rig: Rig) -> None:
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("time_mode:=lockstep")
    forms = [
        (rig.node.create_publisher(Float64, "voltage_command", 10), lambda volts: Float64(data=volts)),
        (rig.node.create_publisher(JointState, "joint_command", AS_HARDWARE), joint_state),
        (rig.node.create_publisher(JointCommand, "joint_command/effort", AS_HARDWARE), joint_command),
    ]
    rig.wait(lambda: all(publisher.get_subscription_count() for publisher, _ in forms), "the command inputs")
    states = rig.hear(ActuatorState, "state")
    ticks = itertools.count()

    def on_joint_states(_: JointState) -> None:
        tick = next(ticks)
        publisher, message = forms[tick % 3]
        publisher.publish(message(voltage_at(tick)))

    rig.node.create_subscription(JointState, "joint_states", on_joint_states, 10)
    rig.wait(lambda: len(states) > PERIODS, f"{PERIODS} periods")
    volts = np.repeat([voltage_at(tick) for tick in range(PERIODS)], 20)
    expected = Plant().run(volts, every=20).position
    assert [state.position for state in states[1 : PERIODS + 1]] == list(expected[-PERIODS:])


def test_best_effort_drivers_and_listeners_are_served(rig: Rig) -> None:
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("command_timeout:=0.0", "diagnostics_rate:=5.0")
    publisher = rig.node.create_publisher(JointState, "joint_command", BEST_EFFORT)
    states, reports = rig.hear(ActuatorState, "state", BEST_EFFORT), rig.diagnostics("eha_sim")
    rig.wait(lambda: publisher.get_subscription_count(), "the simulator's command input")
    publisher.publish(JointState(name=["elbow"], effort=[1.0]))
    rig.wait(lambda: any("no effort of a joint piston" in report["message"] for report in reports), "the warning", 10)
    assert reports[-1]["commands_accepted"] == "0"
    publisher.publish(joint_state(0.02))
    rig.wait(lambda: states and states[-1].voltage == 0.02, "the voltage in force", 10)


def test_a_best_effort_driver_in_lockstep_is_named_unless_a_parameter_lets_it_in(rig: Rig) -> None:
    rig.node.destroy_publisher(rig.commands)
    quality = f"qos_overrides.{rig.namespace}/joint_command.subscription.reliability:=best_effort"
    rig.start_sim("time_mode:=lockstep", "diagnostics_rate:=5.0", quality)
    reports = rig.diagnostics("eha_sim")
    shut_out = rig.node.create_publisher(Float64, "voltage_command", BEST_EFFORT)
    let_in = rig.node.create_publisher(JointState, "joint_command", BEST_EFFORT)
    rig.wait(lambda: reports and "best effort" in reports[-1]["message"], "the quality in /diagnostics", 20)
    assert "joint_command" not in reports[-1]["message"]
    rig.wait(lambda: let_in.get_subscription_count(), "the match", 10)
    assert shut_out.get_subscription_count() == 0


def test_a_controller_on_the_simulated_clock_is_not_waited_for_in_vain(rig: Rig) -> None:
    """As ros2_control's manager does: it wants a clock past zero, and a further period, before its first command."""
    rig.start_sim("time_mode:=lockstep", "lockstep_patience:=0.1", "diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_sim")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: len(states) > 3, "periods without a command", 20)
    assert states[-1].position == 0.0
    rig.wait(lambda: "without a command" in reports[-1]["message"], "the warning", 10)
    count = len(states)
    rig.commands.publish(Float64(data=0.02))
    rig.wait(lambda: len(states) > count and states[-1].voltage == 0.02, "the commanded period", 5)


def test_another_clock_is_named(rig: Rig) -> None:
    from rosgraph_msgs.msg import Clock

    rig.start_sim("time_mode:=scaled", "diagnostics_rate:=5.0", "clock_rate:=50.0")
    reports, clocks = rig.diagnostics("eha_sim"), rig.hear(Clock, "/clock")
    rig.wait(lambda: len(clocks) > 20, "the clock")
    stamps = [item.clock.sec * 1_000_000_000 + item.clock.nanosec for item in clocks]
    assert {after - before for before, after in zip(stamps, stamps[1:], strict=False)} == {20_000_000}
    rig.node.create_publisher(Clock, "/clock", 10)
    rig.wait(lambda: "other publishers of /clock" in reports[-1]["message"], "the warning", 20)
