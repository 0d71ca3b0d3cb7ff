"""The simulator as a controller sees it: volts in, sensors out, leakage by parameter, a drive that guards its input."""

from __future__ import annotations

import math
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import Rig
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import Float32, Float64
from std_srvs.srv import SetBool, Trigger

from eha_core.node_parameters import node_name
from eha_core.parameters import catalogue
from eha_core.plant import COLUMNS
from eha_interfaces.msg import ActuatorState
from eha_interfaces.srv import Step

ATMOSPHERE = 101_325.0
HALF_SUPPLY = 1.05e7


def seconds(message: object) -> float:
    stamp = message.header.stamp
    return stamp.sec + stamp.nanosec * 1e-9


def test_the_state_message_carries_every_column() -> None:
    assert tuple(ActuatorState.get_fields_and_field_types()) == ("header", *COLUMNS)


def test_volts_in_pressures_out(rig: Rig) -> None:
    rig.start_sim()
    pressure_a = rig.hear(FluidPressure, "chamber_a/pressure")
    pressure_b = rig.hear(FluidPressure, "chamber_b/pressure")
    joints = rig.hear(JointState, "joint_states")
    rig.wait(lambda: pressure_a and pressure_b and joints, "the first sample")
    assert pressure_a[0].fluid_pressure == pytest.approx(HALF_SUPPLY + ATMOSPHERE, rel=1e-6)
    rig.command(0.02, seconds=1.0)
    # At steady speed the pressures carry damping and spring: A_p (P1 - P2) = B_s v + K_s x.
    joint = joints[-1]
    force = 2000.0 * joint.velocity[0] + 10.0 * joint.position[0]
    difference = pressure_a[-1].fluid_pressure - pressure_b[-1].fluid_pressure
    assert joint.velocity[0] > 0.01
    assert joint.name == ["piston"]
    assert difference * 645e-6 == pytest.approx(force, rel=0.02)
    assert joint.effort[0] == pytest.approx(force, rel=0.02)


def test_a_single_rod_cylinder_lives_in_the_node(rig: Rig) -> None:
    rig.start_sim("plant.cylinder:=single_rod", "piston_area:=1.2e-3", "piston_area_b:=7.8e-4", "internal_leakage:=0.0")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: states, "the first state")
    rig.command(0.02, seconds=1.0)
    state = states[-1]
    assert state.velocity > 0.01
    assert state.flow_a / state.velocity == pytest.approx(1.2e-3, rel=1e-2)
    assert state.flow_b / state.velocity == pytest.approx(7.8e-4, rel=1e-2)
    named = rig.call(GetParameters, "eha_sim/get_parameters", names=["plant.source", "plant.cylinder"]).values
    assert [value.string_value for value in named] == ["servo_valve", "single_rod"]


def test_samples_come_at_the_rate_with_even_stamps(rig: Rig) -> None:
    rig.start_sim("publish_rate:=200.0")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: len(states) > 400, "two seconds of samples")
    steps = [seconds(after) - seconds(before) for before, after in zip(states, states[1:], strict=False)]
    assert max(steps) == pytest.approx(0.005, abs=1e-6)
    assert min(steps) == pytest.approx(0.005, abs=1e-6)


def test_leakage_is_turned_by_the_parameter_service(rig: Rig) -> None:
    rig.start_sim()
    states = rig.hear(ActuatorState, "state")
    value = Parameter("internal_leakage", value=1e-10).to_parameter_msg()
    answer = rig.call(SetParameters, "eha_sim/set_parameters", parameters=[value])
    assert answer.results[0].successful
    rig.wait(lambda: states and states[-1].internal_leakage == 1e-10, "the leakage in the state", 5)
    latched = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
    late = rig.hear(Float64, "internal_leakage", latched)
    rig.wait(lambda: late, "the latched leakage", 5)
    assert late[-1].data == 1e-10


def test_a_number_that_yaml_takes_for_text_is_taken_as_a_number(rig: Rig) -> None:
    rig.start_sim()
    value = Parameter("internal_leakage", value="1e-10").to_parameter_msg()
    assert rig.call(SetParameters, "eha_sim/set_parameters", parameters=[value]).results[0].successful
    got = rig.call(GetParameters, "eha_sim/get_parameters", names=["internal_leakage"]).values[0]
    assert got.double_value == 1e-10


def test_every_plant_parameter_is_described_with_unit_and_range(rig: Rig) -> None:
    rig.start_sim()
    names = sorted({node_name(name) for name in catalogue()})
    described = rig.call(DescribeParameters, "eha_sim/describe_parameters", names=names).descriptors
    found = {item.name: item for item in described}
    for name, row in catalogue().items():
        item = found[node_name(name)]
        if item.name.endswith(".knots"):
            assert item.additional_constraints == f"25 numbers from {row.lower:g} to {row.upper:g}"
            continue
        assert f"[{row.unit}]" in item.description
        assert ("orders of magnitude" in item.description) == row.logarithmic  # what rqt_reconfigure shows
        bounds = item.floating_point_range[0]
        assert (bounds.from_value, bounds.to_value, bounds.step) == (row.lower, row.upper, 0.0)  # every value between


def test_names_of_before_are_read_with_a_warning_and_laws_are_lists(rig: Rig) -> None:
    given = ("external_leakage.coefficient_a:=1.0e-17", "recovered_force.knot_03:=7.0")
    sim = rig.start_sim(*given)
    rig.wait(lambda: "coefficient_a is now external_leakage_effect.coefficient_a" in sim.output, "the warning", 10)
    names = ["external_leakage_effect.coefficient_a", "recovered_force.knots"]
    leak, law = rig.call(GetParameters, "eha_sim/get_parameters", names=names).values
    assert leak.double_value == 1e-17
    assert list(law.double_array_value) == [7.0 if knot == 3 else 0.0 for knot in range(25)]
    values = [("recovered_force.knots", [1.0] * 24), ("recovered_force.knots", [1e9] * 25), ("coil_resistance", 0)]
    answers = [
        rig.call(SetParameters, "eha_sim/set_parameters", parameters=[Parameter(name, value=value).to_parameter_msg()])
        for name, value in values
    ]
    reasons = [answer.results[0].reason for answer in answers]
    assert "no list of 25 numbers" in reasons[0]
    assert "out of range" in reasons[1] and "range" in reasons[2]
    whole = Parameter("recovered_force.knots", value=[5.0] * 25).to_parameter_msg()
    assert rig.call(SetParameters, "eha_sim/set_parameters", parameters=[whole]).results[0].successful
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: states and states[-1].position > 0.0, "the piston pushed by the law", 10)


@pytest.mark.parametrize(
    "changes",
    [
        {"moving_mass": 12.0, "bulk_modulus": -1.0},
        {"moving_mass": 12.0, "return_pressure": 9e6, "supply_pressure": 8e6},
    ],
)
def test_a_change_is_refused_as_a_whole_with_the_reason(rig: Rig, changes: dict[str, float]) -> None:
    rig.start_sim()
    values = [Parameter(name, value=value).to_parameter_msg() for name, value in changes.items()]
    result = rig.call(SetParametersAtomically, "eha_sim/set_parameters_atomically", parameters=values).result
    assert not result.successful
    assert list(changes)[1] in result.reason
    got = rig.call(GetParameters, "eha_sim/get_parameters", names=list(changes)).values
    assert [value.double_value for value in got] == [catalogue()[name].nominal for name in changes]


def test_the_drive_guards_its_input(rig: Rig) -> None:
    rig.start_sim("diagnostics_rate:=10.0", "command_timeout:=0.3")
    reports = rig.diagnostics("eha_sim")
    states = rig.hear(ActuatorState, "state")
    rig.wait(lambda: states, "the first state")
    # slowly: of commands that come between two of the simulator's looks the newest alone counts
    rig.command(math.nan, seconds=0.5, rate=10.0)
    rig.command(-math.inf, seconds=0.2, rate=10.0)
    rig.command(1e6, seconds=0.3, rate=10.0)
    rig.wait(lambda: any(report["commands_clamped"] == "3" for report in reports), "the clamped commands")
    assert reports[-1]["commands_refused"] == "7"
    assert max(state.voltage for state in states) == 10.0
    assert any("refused" in report["message"] for report in reports)
    rig.wait(lambda: "the voltage is zero" in reports[-1]["message"], "the timeout")
    rig.wait(lambda: states[-1].voltage == 0.0, "zero volts", 2)
    assert all(math.isfinite(state.position) and abs(state.position) <= 0.1 for state in states)
    assert reports[-1]["command_timeouts"] == "1"


def test_health_of_real_time_is_reported(rig: Rig) -> None:
    rig.start_sim("diagnostics_rate:=2.0")
    reports = rig.diagnostics("eha_sim")
    rig.wait(lambda: len(reports) >= 4, "diagnostics")
    assert float(reports[-1]["real_time_factor"]) == pytest.approx(1.0, abs=0.1)
    assert 0.0 <= float(reports[-1]["lateness_mean"]) <= float(reports[-1]["lateness_max"])
    percentiles = [float(reports[-1][f"lateness_{name}"]) for name in ("p50", "p99", "p999", "max")]
    assert percentiles == sorted(percentiles)
    assert {"overruns", "lost_time"} <= reports[-1].keys()


def test_pause_step_reset(rig: Rig) -> None:
    rig.start_sim("command_timeout:=0.0")
    states = rig.hear(ActuatorState, "state")
    rig.command(0.02, seconds=0.3)
    refused = rig.call(Step, "eha_sim/step", steps=10)
    assert not refused.success and "pause" in refused.message
    assert rig.call(SetBool, "eha_sim/pause", data=True).success
    rig.spin(0.2)
    count, before = len(states), rig.call(Step, "eha_sim/step", steps=1000)
    rig.wait(lambda: len(states) > count, "the stepped state")
    after = rig.call(Step, "eha_sim/step", steps=1000)
    assert before.success and after.time - before.time == pytest.approx(0.1, abs=1e-9)
    rig.wait(lambda: len(states) > count + 1, "the second stepped state")
    assert states[-1].position > states[-2].position > 0.0
    assert rig.call(Trigger, "eha_sim/reset").success
    assert rig.call(SetBool, "eha_sim/pause", data=False).success
    rig.wait(lambda: states[-1].position == 0.0 and states[-1].voltage == 0.0, "the initial state", 5)
    assert states[-1].pressure_a == pytest.approx(HALF_SUPPLY, rel=1e-6)


def test_absurd_steps_are_refused_and_many_are_taken_in_slices(rig: Rig) -> None:
    sim = rig.start_sim("start_paused:=true")
    refused = rig.call(Step, "eha_sim/step", steps=4_294_967_295)
    assert not refused.success and "10000000 at most" in refused.message
    taken = rig.call(Step, "eha_sim/step", steps=10_000_000)
    assert taken.success and taken.time == pytest.approx(1000.0)
    status = Path(f"/proc/{sim.process.pid}/status").read_text()
    peak = next(line for line in status.splitlines() if line.startswith("VmHWM"))
    assert int(peak.split()[1]) < 700_000  # kB


def test_stamps_go_on_after_steps_that_went_ahead_of_the_clock(rig: Rig) -> None:
    rig.start_sim("start_paused:=true", "diagnostics_rate:=5.0")
    states, reports = rig.hear(ActuatorState, "state"), rig.diagnostics("eha_sim")
    assert rig.call(Step, "eha_sim/step", steps=30_000).success  # 3 s at once
    assert rig.call(SetBool, "eha_sim/pause", data=False).success
    rig.wait(lambda: len(states) > 200, "states")
    stamps = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in states]
    steps = [later - earlier for earlier, later in zip(stamps, stamps[1:], strict=False)]
    assert min(steps) >= 2_000_000
    rig.wait(lambda: "ahead of the wall clock" in reports[-1]["message"], "the lead in /diagnostics")


def test_a_process_that_stood_still_says_so(rig: Rig) -> None:
    sim = rig.start_sim("diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_sim")
    rig.wait(lambda: len(reports) > 2, "diagnostics")
    sim.process.send_signal(signal.SIGSTOP)
    rig.spin(2.0)
    sim.process.send_signal(signal.SIGCONT)
    assert rig.wait(lambda: any("the process stood still" in report["message"] for report in reports), "the pause said")
    assert rig.wait(lambda: any("of time lost" in report["message"] for report in reports), "the loss said")


def test_help_is_printed_and_nothing_started(tmp_path: Path) -> None:
    for executable in ("sim", "monitor"):
        command = [sys.executable, "-m", f"eha_sim_node.{executable}", "--help"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith(f"usage: ros2 run eha_sim_node {executable} ")
        assert "\n  diagnostics_rate " in done.stdout


def test_scaled_time_runs_at_its_factor_and_owns_the_clock(rig: Rig) -> None:
    from rosgraph_msgs.msg import Clock

    rig.start_sim("time_mode:=scaled", "real_time_factor:=5.0", "diagnostics_rate:=1.0")
    clocks = rig.hear(Clock, "/clock")
    reports = rig.diagnostics("eha_sim")
    rig.wait(lambda: len(reports) >= 3, "diagnostics")
    assert float(reports[-1]["real_time_factor"]) == pytest.approx(5.0, rel=0.1)
    assert clocks[-1].clock.sec < 100  # simulated time, not the wall clock's


def test_a_command_of_another_type_is_named(rig: Rig) -> None:
    sim = rig.start_sim("diagnostics_rate:=5.0")
    reports = rig.diagnostics("eha_sim")
    rig.node.destroy_publisher(rig.commands)
    wrong = rig.node.create_publisher(Float32, "voltage_command", 10)
    for _ in range(20):
        wrong.publish(Float32(data=1.0))
        rig.spin(0.02)
    rig.wait(lambda: reports and "std_msgs/msg/Float32" in reports[-1]["message"], "the wrong type in /diagnostics")
    assert sim.output.count("std_msgs/msg/Float32") == 1
