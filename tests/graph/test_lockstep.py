"""Lockstep: one command a period, the simulator owns time, and the same commands give the same bytes."""

from __future__ import annotations

import math
import signal

import pytest
import rclpy
from conftest import Rig
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from eha_core.plant import Plant
from eha_interfaces.msg import ActuatorState
from eha_interfaces.srv import Step

PERIODS = 200


def nanoseconds(message: JointState) -> int:
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def answer_each_tick(rig: Rig, ticks: list[int], until: int) -> None:
    """A reactive controller: one sine sample for each joint_states, and none after the last."""

    def on_joint_states(message: JointState) -> None:
        ticks.append(nanoseconds(message))
        if len(ticks) <= until:
            rig.commands.publish(Float64(data=0.02 * math.sin(2 * math.pi * 5 * ticks[-1] * 1e-9)))

    rig.node.create_subscription(JointState, "joint_states", on_joint_states, 10)


def test_two_runs_publish_identical_bytes_and_match_the_plant(rig: Rig) -> None:
    types = {
        "joint_states": JointState,
        "state": ActuatorState,
        "chamber_a/pressure": FluidPressure,
        "chamber_b/pressure": FluidPressure,
        "/clock": Clock,
    }
    runs = []
    for run in range(2):
        sim = rig.start_sim("time_mode:=lockstep", "start_paused:=true", "coulomb_friction.force:=20.0")
        heard = {topic: rig.hear(kind, topic, raw=True) for topic, kind in types.items()}
        ticks: list[int] = []
        answer_each_tick(rig, ticks, PERIODS)
        rig.call(SetBool, "eha_sim/pause", data=False)
        rig.wait(lambda ticks=ticks: len(ticks) == PERIODS + 1, f"{PERIODS} periods")
        rig.spin(0.3)
        assert ticks == [2_000_000 * tick for tick in range(PERIODS + 1)]
        runs.append({topic: [bytes(data) for data in messages] for topic, messages in heard.items()})
        assert sim.end() == 0
        if run == 0:
            renew(rig)
    assert {topic: len(messages) for topic, messages in runs[0].items()} == dict.fromkeys(types, PERIODS + 1)
    assert runs[0] == runs[1]
    plant = Plant({"coulomb_friction.force": 20.0})
    for tick in range(PERIODS):
        plant.advance(0.02 * math.sin(2 * math.pi * 5 * (2_000_000 * tick) * 1e-9), 20)
    last = deserialize_message(runs[0]["state"][-1], ActuatorState)
    assert (last.position, last.pressure_a) == (plant.state.position, plant.state.pressure_a)


def renew(rig: Rig) -> None:
    """Come back as a new controller in the same namespace."""
    rig.node.destroy_node()
    rig.node = rclpy.create_node("test_controller", namespace=rig.namespace)
    rig.commands = rig.node.create_publisher(Float64, "voltage_command", 10)


def test_a_period_waits_for_its_command(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep")
    ticks: list[int] = []
    answer_each_tick(rig, ticks, 3)
    rig.wait(lambda: len(ticks) == 4, "three periods")
    rig.spin(1.0)
    assert len(ticks) == 4
    rig.commands.publish(Float64(data=0.0))
    rig.wait(lambda: len(ticks) == 5, "the fourth period", 5)


def test_a_refused_command_still_takes_its_period(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: states, "the first tick")
    for volts in (0.5, math.nan, 0.25):
        count = len(states)
        rig.commands.publish(Float64(data=volts))
        rig.wait(lambda count=count: len(states) > count, "the next period", 5)
    assert [state.voltage for state in states[1:]] == [0.5, 0.5, 0.25]


def test_a_controller_that_was_killed_is_followed_by_another(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep")
    arguments = ("mode:=voltage", "signal:=sine", "lockstep:=true")
    first = rig.start("reference", *arguments)
    joints = rig.hear(JointState, "joint_states")
    rig.node.destroy_publisher(rig.commands)
    rig.wait(lambda: len(joints) > 100, "a hundred periods")
    first.end(signal.SIGKILL)
    rig.spin(0.5)
    count = len(joints)
    rig.spin(0.3)
    assert len(joints) == count
    rig.start("reference", *arguments)
    rig.wait(lambda: len(joints) > count + 100, "periods driven by the second controller")


def test_steps_while_paused(rig: Rig) -> None:
    rig.start_sim("time_mode:=lockstep", "start_paused:=true")
    ticks: list[int] = []
    answer_each_tick(rig, ticks, 10_000)
    rig.spin(1.0)
    assert ticks == []
    refused = rig.call(Step, "eha_sim/step", steps=30)
    assert not refused.success and "whole number" in refused.message
    answer = rig.call(Step, "eha_sim/step", steps=1000)
    assert answer.success and answer.time == pytest.approx(0.1)
    rig.wait(lambda: len(ticks) == 51, "fifty periods")
    rig.spin(0.5)
    assert ticks[-1] == 100_000_000
    rig.call(SetBool, "eha_sim/pause", data=False)
    rig.wait(lambda: len(ticks) > 200, "free running")
