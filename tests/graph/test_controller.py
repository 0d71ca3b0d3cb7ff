"""The controller node in lockstep does what its law does in a loop with the plant, sample for sample."""

from __future__ import annotations

import numpy as np
from conftest import Rig
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from eha_core.control import Measurement, Target, make_controller
from eha_core.parameters import nominal_values
from eha_core.plant import Plant
from eha_core.signals import make_signal, signals
from eha_interfaces.msg import ActuatorState

PERIODS = 500


def expected_positions() -> list[float]:
    given = {"amplitude": 0.01, "frequency": 1.0}
    rows = signals()["sine"].parameters()
    reference = make_signal("sine", {row.name: given.get(row.name, row.default) for row in rows})
    controller, plant, positions = make_controller("lqr", nominal_values(), 0.002, 10.0), Plant(), []
    for tick in range(PERIODS):
        state, time = plant.state, tick * 2_000_000 / 1_000_000_000
        measured = Measurement(state.measured_position, state.measured_velocity, state.hydraulic_force)
        target = Target(float(reference.value(time)), float(reference.derivative(time)))
        plant.advance(controller.voltage(measured, target), 20)
        positions.append(plant.state.position)
    return positions


def test_the_node_leads_the_piston_as_its_law_does(rig: Rig) -> None:
    rig.node.destroy_publisher(rig.commands)
    rig.start_sim("time_mode:=lockstep")
    states = rig.hear(ActuatorState, "state")
    rig.start("reference", "mode:=position", "lockstep:=true", "signal:=sine", "sine.amplitude:=0.01")
    rig.client_ready("eha_reference/reset")
    rig.start("controller", "controller:=lqr")
    rig.wait(lambda: len(states) > PERIODS, f"{PERIODS} periods")
    by_stamp = {(state.header.stamp.sec, state.header.stamp.nanosec): state.position for state in states}
    np.testing.assert_array_equal(
        sorted(by_stamp)[1 : PERIODS + 1], [divmod((k + 1) * 2_000_000, 10**9) for k in range(PERIODS)]
    )
    np.testing.assert_array_equal([by_stamp[key] for key in sorted(by_stamp)][1 : PERIODS + 1], expected_positions())
    value = Parameter("controller", value="pdi").to_parameter_msg()
    refused = rig.call(SetParameters, "eha_controller/set_parameters", parameters=[value]).results[0]
    assert not refused.successful and "give one of pid, cascade" in refused.reason


def test_measurements_without_force_are_named(rig: Rig) -> None:
    joints = rig.node.create_publisher(JointState, "joint_states", 10)
    rig.start("controller", "diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_controller")
    rig.wait(joints.get_subscription_count, "the controller")
    rig.wait(lambda: reports, "a report")
    joints.publish(JointState(name=["piston"], position=[0.0], velocity=[0.0]))
    assert rig.wait(lambda: any("without the joint's" in report["message"] for report in reports), "the warning", 10)
